"""The comparison as one page without scripts from elsewhere: videos side by side, paths plotted, the tables."""

import html
import os

STYLE = """
body { font: 15px/1.4 sans-serif; margin: 1.5em auto; max-width: 1900px; padding: 0 1em; color: #222; }
table { border-collapse: collapse; margin: 1em 0; }
td, th { padding: .2em .7em; text-align: right; border-bottom: 1px solid #ddd; }
td:first-child, th:first-child { text-align: left; }
.videos { display: grid; grid-template-columns: repeat(auto-fill, minmax(420px, 1fr)); gap: .6em; }
figure { margin: 0; } video { width: 100%; display: block; background: #000; }
svg { width: 100%; height: auto; background: #fafafa; }
button { font: inherit; padding: .3em 1em; margin-bottom: .6em; }
"""
# Plays the videos of a section from the start, all at once.
SCRIPT = """
function together(button) {
  const videos = [...button.parentElement.querySelectorAll('video')];
  videos.forEach(video => { video.pause(); video.currentTime = 0; });
  videos.forEach(video => video.play());
}
"""
COLOURS = ("#999999", "#e69f00", "#56b4e9", "#d55e00", "#cc79a7", "#009e73", "#0072b2", "#8c564b", "#bcbd22",
           "#7f3fbf", "#000000")
AXES = ("pitch", "yaw", "roll")
WIDTH, HEIGHT, MARGIN = 1200, 170, 40


def polyline(points, colour, x_of, y_of):
    places = " ".join(f"{x_of(x):.1f},{y_of(y):.2f}" for x, y in points)
    return f'<polyline points="{places}" fill="none" stroke="{colour}" stroke-width="1.3"/>'


def plot(rows, axis):
    """Degrees about one axis since the first frame, over seconds, of all rows; one SVG."""
    curves = [[(t_s, turn_deg[axis]) for t_s, *turn_deg in row.judgement["path_deg"]] for row in rows]
    everything = [point for curve in curves for point in curve]
    if not everything:
        return ""
    end_s = max(x for x, _ in everything)
    low, high = min(y for _, y in everything) - 0.1, max(y for _, y in everything) + 0.1

    def x_of(t_s):
        return MARGIN + (WIDTH - MARGIN) * t_s / end_s

    def y_of(deg):
        return HEIGHT * (high - deg) / (high - low)
    lines = [polyline(curve, COLOURS[i % len(COLOURS)], x_of, y_of) for i, curve in enumerate(curves)]
    labels = [f'<text x="2" y="{y}" font-size="12">{text}</text>'
              for y, text in ((12, f"{high:.1f}°"), (HEIGHT / 2, AXES[axis]), (HEIGHT - 3, f"{low:.1f}°"))]
    return f'<svg viewBox="0 0 {WIDTH} {HEIGHT}">{"".join(lines + labels)}</svg>'


def table(rows, headings, cells):
    head = "".join(f"<th>{html.escape(heading)}</th>" for heading in ("", *headings))
    body = "".join(
        f'<tr><td><span style="color:{COLOURS[i % len(COLOURS)]}">&#9632;</span> {html.escape(row.name)}</td>'
        + "".join(f"<td>{cell}</td>" for cell in cells(row.judgement)) + "</tr>" for i, row in enumerate(rows))
    return f"<table><tr>{head}</tr>{body}</table>"


def videos(rows, folder):
    figures = "".join(
        f'<figure><video src="{html.escape(os.path.relpath(row.video, folder))}" controls muted loop playsinline '
        f'preload="metadata"></video><figcaption>{html.escape(row.name)}</figcaption></figure>' for row in rows)
    return (f'<div><button onclick="together(this)">play all from the start</button>'
            f'<div class="videos">{figures}</div></div>')


def section(comparison, folder, headings, cells):
    session, rows = comparison.session, comparison.rows
    return (f"<h2>{html.escape(session.name)}</h2><p>{html.escape(session.description)}; zoom {comparison.zoom:g}</p>"
            + videos(rows, folder) + table(rows, headings, cells) + f"<p>{html.escape(comparison.bound)}</p>"
            + "<p>How the camera of each video turns since its first frame, as its pictures tell, about axes that"
              " lie as that frame's: x to the right, y down, z forward.</p>"
            + "".join(plot(rows, axis) for axis in range(len(AXES))))


def write(file, results, headings, cells, explanation):
    sections = "".join(section(comparison, file.parent.resolve(), headings, cells) for comparison in results)
    file.write_text(f"<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Stabilizers compared"
                    f"</title><style>{STYLE}</style><script>{SCRIPT}</script></head><body><h1>Stabilizers compared"
                    f"</h1><p>{html.escape(explanation)}</p>{sections}</body></html>\n", encoding="utf-8")
