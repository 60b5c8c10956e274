"""Plot of the time per step and consumer over the number of consumers, from the table of README.md beside it.

`python benches/plot_steps.py` writes steps.svg; `make bench-thermal` prints the rows of the table. No packages needed.
"""

import math
import re
from pathlib import Path

HERE = Path(__file__).parent
WIDTH, HEIGHT, LEFT, BOTTOM = 560, 260, 60, 45


def rows(text):
    """Consumers, least and largest time per step and consumer, us."""
    table = text[text.index("| Consumers | Edges | Per step, µs |") :].split("\n\n")[0]
    for line in table.splitlines()[2:]:
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        times = [float(number) for number in re.findall(r"[\d.]+", cells[3])]
        yield int(cells[0].replace(" ", "")), min(times), max(times)


def main():
    points = list(rows((HERE / "README.md").read_text(encoding="utf-8")))
    top = math.ceil(2 * max(high for _, _, high in points)) / 2
    first, last = math.log10(points[0][0]), math.log10(points[-1][0])

    def x(consumers):
        return LEFT + (math.log10(consumers) - first) / (last - first) * (WIDTH - LEFT - 20)

    def y(us):
        return HEIGHT - BOTTOM - us / top * (HEIGHT - BOTTOM - 15)

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
    ]
    for k in range(int(2 * top) + 1):
        at = y(k / 2)
        parts.append(f'<path d="M{LEFT} {at:.1f}H{WIDTH - 20}" stroke="#ddd"/>')
        parts.append(f'<text x="{LEFT - 8}" y="{at + 4:.1f}" text-anchor="end">{k / 2}</text>')
    for consumers, low, high in points:
        at = x(consumers)
        parts.append(f'<text x="{at:.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{consumers}</text>')
        parts.append(f'<path d="M{at:.1f} {y(low):.1f}V{y(high):.1f}" stroke="#1f77b4" stroke-width="3"/>')
        parts.append(f'<circle cx="{at:.1f}" cy="{y(low):.1f}" r="4" fill="#1f77b4"/>')
    line = " ".join(f"{x(consumers):.1f},{y(low):.1f}" for consumers, low, _ in points)
    parts.append(f'<polyline points="{line}" fill="none" stroke="#1f77b4"/>')
    parts.append(f'<text x="{(LEFT + WIDTH) / 2}" y="{HEIGHT - 6}" text-anchor="middle">consumers</text>')
    middle = (HEIGHT - BOTTOM) / 2
    parts.append(
        f'<text x="16" y="{middle}" text-anchor="middle" transform="rotate(-90 16 {middle})">'
        "per step and consumer, µs</text>"
    )
    parts.append("</svg>\n")
    (HERE / "steps.svg").write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
