"""Theme of the application: Fusion style, one font and a few greys, defined once for all widgets."""

from string import Template

from PySide6.QtGui import QColor, QFont, QFontDatabase, QIcon, QPalette
from PySide6.QtWidgets import QApplication

from studio.document import colours
from studio.resources_folder import resources_folder

FONT_FAMILIES = ("Inter", "Segoe UI", "SF Pro Text", "Noto Sans")
FONT_SIZE_PX = 13
FALLBACK_FAMILY = "DejaVu Sans"
FALLBACK_STRETCH_PERCENT = 92  # percent: DejaVu is a good deal wider than the faces that the measures were made for


def apply_theme(application: QApplication) -> None:
    """Apply style, palette, font and style sheet to the application."""
    application.setStyle("Fusion")
    application.setPalette(make_palette())
    application.setFont(make_font())
    application.setStyleSheet(style_sheet())
    application.setWindowIcon(QIcon(str(resources_folder() / "icons" / "studio.svg")))


def make_font() -> QFont:
    """Inter if it is installed, else the system's sans serif font, with tabular figures."""
    present = set(QFontDatabase.families())
    font = QFont(next((family for family in FONT_FAMILIES if family in present), QFont().defaultFamily()))
    if font.family() not in present and FALLBACK_FAMILY in present:
        font = QFont(FALLBACK_FAMILY)
        font.setStretch(FALLBACK_STRETCH_PERCENT)
    font.setPixelSize(FONT_SIZE_PX)
    return font


def make_palette() -> QPalette:
    """Qt palette with the greys of the theme, for widgets without style sheet rules."""
    roles = QPalette.ColorRole
    palette = QPalette()
    for role, colour in (
        (roles.Window, colours.PANEL),
        (roles.WindowText, colours.TEXT),
        (roles.Base, colours.WELL),
        (roles.AlternateBase, colours.PANEL),
        (roles.Text, colours.TEXT),
        (roles.PlaceholderText, colours.TEXT_THIRD),
        (roles.Button, colours.CONTROL),
        (roles.ButtonText, colours.TEXT),
        (roles.ToolTipBase, colours.CONTROL),
        (roles.ToolTipText, colours.TEXT),
        (roles.Highlight, colours.SELECTED_CONTROL),
        (roles.HighlightedText, "#ffffff"),
        (roles.Link, colours.kind_colour("position")),
        (roles.Mid, colours.EDGE),
        (roles.Dark, colours.WINDOW),
        (roles.Light, colours.CONTROL),
    ):
        palette.setColor(role, QColor(colour))
    for role in (roles.Text, roles.WindowText, roles.ButtonText):
        palette.setColor(QPalette.ColorGroup.Disabled, role, QColor(colours.TEXT_THIRD))
    return palette


def style_sheet() -> str:
    """``resources/theme/studio.qss`` with the colours filled in."""
    text = (resources_folder() / "theme" / "studio.qss").read_text(encoding="utf-8")
    return Template(text).substitute(
        icons=(resources_folder() / "icons").as_posix(),
        window=colours.WINDOW,
        well=colours.WELL,
        panel=colours.PANEL,
        bar=colours.BAR,
        control=colours.CONTROL,
        edge=colours.EDGE,
        text=colours.TEXT,
        second=colours.TEXT_SECOND,
        third=colours.TEXT_THIRD,
        selected_row=colours.SELECTED_ROW,
        selected_control=colours.SELECTED_CONTROL,
        selected_handle=colours.SELECTED_HANDLE,
        partly=colours.PARTLY,
        kind_position=colours.kind_colour("position"),
    )
