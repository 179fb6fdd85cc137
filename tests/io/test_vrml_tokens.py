"""VRML is cut into tokens as a reader of one character after another would, on every Python; as texts and JSON are."""

import json
import re
from collections.abc import Iterator
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.io.hanim.scene import SceneNode, row_of
from studio.io.hanim.vrml import _tokens, read_vrml
from studio.io.json_text import MOST_JSON_DEPTH, json_of

PIECES = (*'01.eE+-x#,"\\ab[]{} \n\t', "0x1F", "12.5 ", "-3e-2,", "1 ", '\\"', "\\\\", "DEF ")
DELIMITERS = '[]{}"#,'


def is_number(word: str) -> bool:
    """True if a word is a plain decimal number."""
    return re.fullmatch(r"[-+]?([0-9]+|[0-9]+\.[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?", word) is not None


def end_of_string(text: str, start: int) -> int:
    """Index behind the quote that closes the text begun at ``start``; 0 where none does."""
    place = start + 1
    while place < len(text) and text[place] != '"':
        place += 2 if text[place] == "\\" else 1
    return place + 1 if place < len(text) else 0


def tokens_by_hand(text: str) -> Iterator[tuple[str, str]]:
    """Kind and text of each token, without gaps."""
    place = 0
    while place < len(text):
        letter, start = text[place], place
        if letter.isspace() or letter == ",":
            place += 1
        elif letter == "#":
            while place < len(text) and text[place] not in "\r\n":
                place += 1
        elif letter == '"':
            place = end_of_string(text, start) or start + 1
            yield ("string" if end_of_string(text, start) else "wrong"), text[start:place]
        elif letter in "[]{}":
            place += 1
            yield "mark", letter
        elif hexadecimal := re.match("0[xX][0-9a-fA-F]+", text[place:]):
            place += hexadecimal.end()
        else:
            while place < len(text) and not text[place].isspace() and text[place] not in DELIMITERS:
                place += 1
            ended = place == len(text) or text[place].isspace() or text[place] in ",]}#"
            word = text[start:place]
            yield ("number" if is_number(word) and ended else "word"), word


def single_tokens(text: str) -> list[tuple[str, str]]:
    """The studio's tokens, with a row of numbers taken apart."""
    found: list[tuple[str, str]] = []
    for token in _tokens(text):
        if token.kind == "numbers":
            found += [("number", word) for word in re.split(r"[\s,]+", token.text) if word]
        else:
            found.append((token.kind, token.text))
    return found


def test_a_text_is_cut_as_reading_letter_by_letter_cuts_it():
    chance = Random(7)
    for _ in range(5000):
        text = "".join(chance.choices(PIECES, k=chance.randrange(40)))
        assert single_tokens(text) == list(tokens_by_hand(text)), text


@given(st.lists(st.text('ab\\"\n ', max_size=8), min_size=1, max_size=5))
def test_texts_of_an_attribute_come_back_without_quotes_and_escapes(texts):
    written = " ".join('"' + re.sub(r'(["\\])', r"\\\1", text) + '"' for text in texts)

    assert SceneNode("Anchor", "here", fields={"url": written}).texts("url") == texts


@given(st.recursive(st.text('[{"\\ab', max_size=9), st.lists), st.booleans())
def test_brackets_in_names_of_json_nest_nothing(record, closed):
    content = json.dumps([record, "[" * 2 * MOST_JSON_DEPTH, '\\"[' * 2 * MOST_JSON_DEPTH]).encode()

    assert json_of(content)[0] == record
    with pytest.raises(ValueError, match=r"nested too deeply|Expecting|Extra|delimiter"):
        json_of(b"[" * 2 * MOST_JSON_DEPTH + content + (b"]" * 2 * MOST_JSON_DEPTH if closed else b""))


def test_a_row_of_many_numbers_is_one_value_with_or_without_brackets(tmp_path):
    numbers = " ".join(str(number) for number in range(2500))
    file = tmp_path / "rows.wrl"
    file.write_text(f"#VRML V2.0 utf8\nPixelTexture {{ image {numbers} # end\n points [ {numbers} ] }}")

    [node] = read_vrml(file)

    assert node.fields["image"].tolist() == node.fields["points"].tolist() == row_of(numbers, "here").tolist()
