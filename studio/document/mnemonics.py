"""Names of the user in texts in which Qt takes ``&`` for the mark of a mnemonic."""


def escaped_mnemonics(text: str) -> str:
    """Text for a button, menu or tab that shows every ``&`` and marks no letter as a key."""
    return text.replace("&", "&&")
