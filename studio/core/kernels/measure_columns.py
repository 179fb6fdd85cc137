"""Columns of the measures of a body, imported as ``measure``.

A body (``Morphology.packed``) has 57 + 3 K numbers, in metres; those of the spine come last. Each column is the first
one of its quantity; the number of columns follows as a comment.
"""

NECK = 0  # 1   length
HEAD = 1  # 1   length
COLLAR_BASE = 2  # 2 x 3 collars from the neck base, in the thorax
CLAVICLE = 8  # 2   lengths
ARM = 10  # 2 x 2 lengths of upper arm and forearm
HAND = 14  # 2 x 3 wrist to finger tips, in the hand
HIP_OFFSET = 20  # 2 x 3 hips from the root, in the pelvis
LEG = 26  # 2 x 2 lengths of thigh and shank
FOOT = 30  # 2 x 3 ankle to toe joint, in the foot
TOE = 36  # 2 x 3 toe joint to tip, in the toe
ANKLE_HEIGHT = 42  # 2   above the sole
TOE_HEIGHT = 44  # 2   of the toe joint above the sole
HEEL_LENGTH = 46  # 2   heel behind the ankle
NECK_REST = 48  # 3   rest direction in the thorax
CLAVICLE_REST = 51  # 2 x 3 rest directions in the thorax
SPINE = 57  # K x 3 each spine segment, in its own axes
