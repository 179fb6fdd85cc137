from PySide6.QtGui import QAction

from studio.panels.command_palette import ranked


def found(words, *texts):
    actions = [QAction(text) for text in texts]
    return [action.text() for action in ranked(actions, words)]


def test_words_that_stand_together_come_before_letters_that_only_follow_each_other(qapp):
    assert found("fra", "Far ahead", "Next frame", "Frame all") == ["Frame all", "Next frame", "Far ahead"]


def test_letters_in_their_order_are_enough(qapp):
    assert found("sinc", "Save increment", "Save") == ["Save increment"]


def test_nothing_typed_finds_everything_in_the_order_of_the_table(qapp):
    assert found("", "B", "A") == ["B", "A"]
