"""Motion library: folders of captures, the clips found in them, and the search for a clip that hits a target.

A search passes through these modules:

- ``indexing`` reads the captures, ``proposed_strikes`` proposes their clips, ``hit_paths`` computes where each can hit;
- ``catalogue`` stores them with their labels (``clip_labels``), ``library`` loads them as the table that is searched;
- ``searching`` turns a pose and a target into a query; ``core.clip_search`` finds the best frames by the kernels of
  ``core.kernels.pose_search``;
- ``striking`` makes a motion of a clip that was found, and the constraint that drives it to the target;
- ``inserted_strike`` inserts it into a project, and solves it there to see if it hits.
"""
