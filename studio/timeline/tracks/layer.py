"""Layer tracks of a performer, one for each body region, below its clips; bars are as high as the layer's weight."""

from PySide6.QtCore import QPointF, QRect, QRectF
from PySide6.QtGui import QPainter, QPainterPath, QPolygonF

from studio.core.curves.activation import EaseShape, ease
from studio.core.stage.clip import Clip
from studio.core.stage.layer import Layer, Region
from studio.document import colours
from studio.timeline.shown import RowContext, label_area
from studio.timeline.tracks.brush import paint_label
from studio.timeline.tracks.clip import CURVE_STEPS, clip_bar, clip_text, paint_clip_bar, paint_clip_text, visible_part

LAYER_ROW_HEIGHT = 22
LAYER_INDENT_PX = 28
MIN_LAYER_BAR_FRACTION = 0.3
"""Minimum height of a bar as a fraction of the track."""


def rows_of(shown: RowContext, performer_id: str) -> list[tuple[str, str, int]]:
    """Kind, id and height in pixels of the layer tracks of a performer."""
    layers = shown.project.performers[performer_id].layers
    regions = dict.fromkeys(each.region for each in layers)
    return [("layer", f"{performer_id}/{region}", LAYER_ROW_HEIGHT) for region in regions]


def performer_of(row_id: str) -> str:
    """Id of the performer in the id of a layer track."""
    return row_id.rpartition("/")[0]


def clip_bars(shown: RowContext, row: QRect, row_id: str) -> list[tuple[Clip, QRectF]]:
    """Clips of a layer track with their bars, each as high as the track, for hit tests."""
    return [(each.clip, clip_bar(shown, row, each.clip)) for each in _layers(shown, row_id)]


def paint_layers(painter: QPainter, row: QRect, shown: RowContext, row_id: str) -> None:
    """Paint bars that rise and fall with the fades of the layers."""
    for layer, (clip, bar) in zip(_layers(shown, row_id), clip_bars(shown, row, row_id), strict=True):
        low = bar.adjusted(0, (1.0 - max(layer.weight, MIN_LAYER_BAR_FRACTION)) * bar.height(), 0, 0)
        paint_clip_bar(painter, shown, performer_of(row_id), clip, _outline(shown, low, layer))
        paint_clip_text(painter, layer_text(shown, layer), visible_part(shown, bar))


def paint_layer_label(painter: QPainter, row: QRect, row_id: str) -> None:
    """Paint the body region."""
    region = Region(row_id.rpartition("/")[2])
    paint_label(painter, label_area(row).adjusted(LAYER_INDENT_PX, 0, 0, 0), region.label, colours.TEXT_SECOND)


def layer_text(shown: RowContext, layer: Layer) -> str:
    """Text of a layer: its motion and its weight."""
    words = [clip_text(shown, layer.clip)]
    words += ["added"] if layer.additive else []
    words += [f"{layer.weight:.0%}"] if layer.weight < 1.0 else []
    return " · ".join(words)


def _layers(shown: RowContext, row_id: str) -> list[Layer]:
    performer = shown.project.performers[performer_of(row_id)]
    region = row_id.rpartition("/")[2]
    return [each for each in performer.layers if each.region == region]


def _outline(shown: RowContext, bar: QRectF, layer: Layer) -> QPainterPath:
    scale, half = shown.axis.scale, bar.width() / 2
    rise, fall = (min(seconds * scale, half) for seconds in (layer.fade_in, layer.fade_out))
    shares = [step / CURVE_STEPS for step in range(CURVE_STEPS + 1)]
    heights = [bar.bottom() - float(ease(share, EaseShape.QUINTIC)) * bar.height() for share in shares]
    up = [QPointF(bar.left() + share * rise, height) for share, height in zip(shares, heights, strict=True)]
    down = [QPointF(bar.right() - share * fall, height) for share, height in zip(shares, heights, strict=True)]
    path = QPainterPath()
    path.addPolygon(QPolygonF([QPointF(bar.left(), bar.bottom()), *up, *reversed(down), bar.bottomRight()]))
    path.closeSubpath()
    return path
