"""What the views say while there is nothing to see, in the same words."""

from studio.core.project import Project

DROP = "Drop a capture here"
HIDDEN = "All characters are hidden. Shift+H shows them."


def empty_words(project: Project) -> str:
    """What to do, as one line; nothing where somebody is shown and has something to play."""
    performers = project.performers.values()
    if performers and not any(performer.visible for performer in performers):
        return HIDDEN
    return "" if any(performer.clips for performer in performers if performer.visible) else DROP
