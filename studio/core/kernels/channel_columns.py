"""Columns of a frame of channels, imported as ``channel``.

A normalised motion (``core.normalized.motion``) has 93 + 4 (K - 1) numbers a frame; those of the spine come last. Each
column is the first one of its quantity; the number of columns follows as a comment.
"""

HIPS = 0  # 3   middle of the hip joints above the ankles' plane, parts of the leg length
YAW = 3  # 1   low-passed heading of the pelvis
PELVIS = 4  # 4   pelvis relative to the heading
NECK = 8  # 4   away from its rest in the thorax
HEAD = 12  # 4   relative to the thorax carried along by the neck
CLAVICLE = 16  # 2 x 4 away from their rest in the thorax
# 4 x 4 in the pelvis or the thorax carried along by the clavicle: z from limb root to extremity, x the hinge axis
LIMB_FRAME = 24
LIMB_SLACK = 40  # 4   1 - |extremity - root| / limb length (slack, not reach: float32 keeps straight limbs exact)
LIMB_OFF_PLANE = 44  # 4   x of elbow or knee in the limb frame, parts of the limb length
LIMB_BEND = 48  # 4   sign of its y
LIMB_TWIST = 52  # 4 x 2 of both segments about their bone
HAND = 60  # 2 x 4 relative to the forearm
FOOT = 68  # 2 x 4 relative to the pelvis
TOE = 76  # 2 x 4 relative to the foot
HIP_SHIFT = 84  # 2 x 3 how far the hips stray from their place in the pelvis, parts of the leg length
HEAD_SHIFT = 90  # 3   how far the head joint strays from the end of the neck, parts of the neck length
SPINE = 93  # (K-1) x 4 spine segments 1.. relative to the pelvis
QUATERNION_COLUMNS = (PELVIS, NECK, HEAD, *range(CLAVICLE, LIMB_SLACK, 4), *range(HAND, HIP_SHIFT, 4))
"""First columns of the quaternions, without those of the spine."""
