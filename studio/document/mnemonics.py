"""Escaping of names in texts in which Qt reads ``&`` as the mark of a mnemonic."""


def escaped_mnemonics(text: str) -> str:
    """Text for a button, menu or tab, in which every ``&`` is shown as such."""
    return text.replace("&", "&&")
