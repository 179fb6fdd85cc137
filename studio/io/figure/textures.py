"""Pictures inside and beside character files: checked before use, stored unchanged."""

import warnings
from io import BytesIO

import numpy as np
from numpy.typing import NDArray

from studio.core.project_cache import project_cache

LARGEST_SIDE_PIXELS = 8192
"""Greatest side of a picture in pixels."""
STAGE_TEXTURE_SIDE_PIXELS = 2048
"""Greatest side in pixels of a texture on the stage; larger pictures are reduced for display only."""
_FORMATS = ("PNG", "JPEG")


def checked_picture(content: bytes) -> NDArray[np.uint8]:
    """Bytes of a PNG or JPEG that can be shown. Raises ValueError with the reason if it cannot."""
    shown_picture(content)
    return np.frombuffer(content, np.uint8)


@project_cache(maxsize=32)
def shown_picture(content: bytes) -> NDArray[np.uint8]:
    """Pixels of a picture, reduced for the stage; cached, so that a reader can decode it before it is drawn."""
    return decoded_image(content, STAGE_TEXTURE_SIDE_PIXELS)


def decoded_image(content: bytes, largest: int = LARGEST_SIDE_PIXELS) -> NDArray[np.uint8]:
    """Pixels (height, width, 4) RGBA of a PNG or JPEG, reduced if a side exceeds ``largest``.

    The size in its header is checked before memory is allocated. Raises ValueError if it is no picture.
    """
    from PIL import Image, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(BytesIO(content), formats=_FORMATS) as picture:
                if max(picture.size) > LARGEST_SIDE_PIXELS:
                    raise ValueError(
                        f"it claims {picture.width} x {picture.height} pixels, {LARGEST_SIDE_PIXELS} are allowed"
                    )
                picture.draft("RGB", (largest, largest))
                shown = picture.convert("RGBA")
                shown.thumbnail((largest, largest))
                return np.asarray(shown)
    except Image.DecompressionBombError as error:
        raise ValueError("it declares more pixels than are supported") from error
    except UnidentifiedImageError as error:
        raise ValueError("it is neither PNG nor JPEG") from error
    except (OSError, SyntaxError, ArithmeticError, LookupError, TypeError, MemoryError) as error:
        raise ValueError("it is damaged") from error
