"""The SVG files of all plots: text, lines and bars, readable on a light and on a dark background."""

from html import escape

WIDTH, MARGIN = 900, 28


class Drawing:
    """Lines of an SVG file."""

    def __init__(self):
        self.lines = []

    def text(self, x, y, content, style="", anchor="start"):
        self.lines.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" class="{style}">'
                          f'{escape(content)}</text>')

    def line(self, x1, y1, x2, y2, style):
        self.lines.append(f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" class="{style}"/>')

    def bar(self, x, y, width, height, name):
        # Square at the baseline, rounded at the value.
        r = min(2.5, width / 2)
        top, side = f"h{width - r:.1f}a{r:.1f} {r:.1f} 0 0 1 {r:.1f} {r:.1f}", f"v{height - 2 * r:.1f}"
        bottom = f"a{r:.1f} {r:.1f} 0 0 1 {-r:.1f} {r:.1f}h{r - width:.1f}z"
        self.lines.append(f'<path class="fill-{name}" d="M{x:.1f} {y:.1f}{top}{side}{bottom}"/>')


STYLE = """
text{font:12px system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif}
.title{font-size:19px;font-weight:600}
.map{font-size:14px;font-weight:600}
.query{font-weight:500}
.faint{font-size:11px}
.strong{font-weight:600}
.value{font-variant-numeric:tabular-nums;paint-order:stroke;stroke-width:3px}
.rule{stroke-width:1}
.base{stroke-width:1;stroke-dasharray:3 3}
"""


def style_sheet(colours):
    def theme(index, ink, faint, rule, paper):
        fills = "".join(f".fill-{name}{{fill:{pair[index]}}}.line-{name}{{stroke:{pair[index]}}}"
                        for name, pair in colours.items())
        return (f"text{{fill:{ink}}}.faint{{fill:{faint}}}.rule{{stroke:{rule}}}.base{{stroke:{faint}}}"
                f".paper{{fill:{paper}}}.value{{stroke:{paper}}}{fills}")

    light = theme(0, "#1f2328", "#59636e", "#e4e8ec", "#ffffff")
    dark = theme(1, "#e6edf3", "#9198a1", "#2a3038", "#0d1117")
    return f"<style>{STYLE}{light}\n@media (prefers-color-scheme:dark){{{dark}}}</style>"


def svg(title, height, colours, drawing):
    """The whole file; colours: {name: (on light, on dark background)} of the classes fill-name and line-name."""
    head = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:.0f}" width="{WIDTH}" '
            f'height="{height:.0f}" role="img"><title>{escape(title)}</title>')
    paper = f'<rect class="paper" width="{WIDTH}" height="{height:.0f}" rx="8"/>'
    return "\n".join([head, style_sheet(colours), paper, *drawing.lines, "</svg>", ""])


def save(path, text):
    """Writes the file complete or not at all."""
    unfinished = path.with_name(path.name + ".unfinished")
    try:
        unfinished.write_text(text, encoding="utf-8")
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)
