"""Characters that come in are told apart."""

from studio.app.character_import import add_read_character
from studio.app.sample import empty_project
from studio.document.document import Document
from studio.io.project.character_file import bundled_characters


def test_characters_of_one_name_are_numbered() -> None:
    document = Document()
    document.new(empty_project())
    character = next(iter(bundled_characters().values()))
    add_read_character(document, character, "Import")
    add_read_character(document, character, "Import")
    for names in (
        [each.name for each in document.project.characters.values()],
        [each.name for each in document.project.performers.values()],
    ):
        assert names[-2:] == [f"{character.name} 2", f"{character.name} 3"]
