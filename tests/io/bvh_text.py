"""A small BVH file as text, with any part of it replaced."""

HIERARCHY = """HIERARCHY
ROOT Hips
{
  OFFSET 0 90 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Spine
  {
    OFFSET 0 20 0
    CHANNELS 3 Yrotation Zrotation Xrotation
    End Site
    {
      OFFSET 0 30 0
    }
  }
}
"""
ROW = "1.5 90 -2 10 20 30 5 -5 1e1"


def bvh_text(
    rows: list[str] | None = None,
    hierarchy: str = HIERARCHY,
    header: str = "Frames: 3\nFrame Time: 0.0333333\n",
    end: str = "\n",
) -> str:
    """A body of two joints and one end; nine channels, three frames."""
    return hierarchy + "MOTION\n" + header + "\n".join([ROW] * 3 if rows is None else rows) + end
