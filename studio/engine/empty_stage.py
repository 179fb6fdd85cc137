"""Text that views show on an empty stage."""

from studio.core.stage.project import Project

DROP_PROMPT = "Drop a capture here"
ALL_HIDDEN_PROMPT = "All characters are hidden. Shift+H shows them."


def empty_words(project: Project) -> str:
    """Text that tells what to do next on an empty stage; empty if a visible performer has a motion."""
    performers = project.performers.values()
    if performers and not any(performer.visible for performer in performers):
        return ALL_HIDDEN_PROMPT
    return "" if any(performer.clips for performer in performers if performer.visible) else DROP_PROMPT
