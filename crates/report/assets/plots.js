// The plots: linked in time, with chosen series, flagged intervals and the time of the clock.
"use strict";

const COLOURS = 8;
const DASHES = [[], [7, 4], [2, 3], [10, 3, 2, 3]];
const LEAST_SPAN = { "l/min": 0.1, bar: 0.01, "°C": 0.5, kW: 0.01, "–": 0.1 };
const HEIGHT = 230;
const FONT = '12px system-ui, -apple-system, "Segoe UI", Roboto, sans-serif';

function startPlots(data, clock) {
  const times = decode(data.times, Float64Array);
  const span = times.length ? times[times.length - 1] - times[0] : 0;
  const unit =
    [[600, 1, "s"], [10800, 60, "min"], [432000, 3600, "h"]].find(([limit]) => span <= limit) ??
    [0, 86400, "d"];
  const x = Array.from(times, (time) => time / unit[1]);
  const group = uPlot.sync("time");
  const panels = [];

  const slots = new Map();
  /** One colour per place, the same in all plots. */
  function colourOf(key) {
    if (!slots.has(key)) slots.set(key, slots.size % COLOURS);
    return () => css(`--series-${slots.get(key)}`);
  }

  function addPanel(section, plot, panel) {
    const { factor, offset, unit: yUnit } = panel.display;
    const box = section.appendChild(make("div", "panel"));
    const axis = `${panel.title}${yUnit === "–" ? "" : `, ${yUnit}`}`;
    const top = box.appendChild(make("div", "panel-top"));
    if (plot.panels.length > 1) top.append(make("h3", "", panel.title));
    const legend = top.appendChild(make("div", "legend"));
    const chart = box.appendChild(make("div", "chart"));
    chart.setAttribute("role", "img");
    chart.setAttribute("aria-label", `${plot.title}: ${axis} over time`);
    const curves = [];
    const ordinal = new Map();
    for (const series of panel.series) {
      const nth = ordinal.get(series.key) ?? 0;
      ordinal.set(series.key, nth + 1);
      series.dash = DASHES[nth % DASHES.length];
    }

    function values(series) {
      return Array.from(decode(series.data, Float32Array), (value) =>
        Number.isFinite(value) ? value * factor + offset : null,
      );
    }
    function options(series) {
      return {
        label: series.name,
        stroke: colourOf(series.key),
        width: 1.75,
        dash: series.dash.length ? series.dash : undefined,
        points: { show: x.length < 2 },
      };
    }
    function chip(series) {
      const button = make("button", "chip");
      button.type = "button";
      button.setAttribute("aria-pressed", "true");
      const swatch = document.createElementNS("http://www.w3.org/2000/svg", "svg");
      swatch.setAttribute("viewBox", "0 0 22 8");
      swatch.setAttribute("aria-hidden", "true");
      const line = swatch.appendChild(document.createElementNS(swatch.namespaceURI, "path"));
      line.setAttribute("d", "M0 4H22");
      line.setAttribute("stroke-dasharray", series.dash.join(" "));
      colourOf(series.key);
      line.style.stroke = `var(--series-${slots.get(series.key)})`;
      const value = make("b", "", "–");
      button.append(swatch, make("span", "", series.name), value);
      const index = curves.length + 1;
      button.addEventListener("click", () => {
        const on = button.getAttribute("aria-pressed") !== "true";
        button.setAttribute("aria-pressed", String(on));
        u.setSeries(index, { show: on });
      });
      button.addEventListener("pointerenter", () => u.setSeries(index, { focus: true }));
      button.addEventListener("pointerleave", () => u.setSeries(null, { focus: true }));
      legend.append(button);
      return { series, button, value };
    }
    const shown = () =>
      new Set(curves.filter((_, i) => u.series[i + 1].show).map(({ series }) => series.key));

    /** Flagged intervals of the shown places: a tint, and a lane on top in the colour of the place. */
    function drawFlagged() {
      const keys = shown();
      const { ctx, bbox } = u;
      const lanes = [...new Set(data.flagged.map((b) => b.key))].filter((key) => keys.has(key));
      ctx.save();
      ctx.beginPath();
      ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
      ctx.clip();
      const place = ({ from, to }) => {
        const a = u.valToPos(from / unit[1], "x", true);
        const b = u.valToPos((to ?? data.end_s) / unit[1], "x", true);
        return [a, Math.max(b - a, uPlot.pxRatio)];
      };
      const mine = data.flagged.filter((b) => keys.has(b.key));
      for (const blocked of [true, false]) {
        ctx.fillStyle = css(blocked ? "--blocked-tint" : "--swing-tint");
        ctx.beginPath();
        for (const interval of mine.filter(({ kind }) => (kind === "blocked") === blocked)) {
          const [a, width] = place(interval);
          ctx.rect(a, bbox.top, width, bbox.height);
        }
        ctx.fill();
      }
      const lane = Math.min(4, 24 / lanes.length) * uPlot.pxRatio;
      for (const interval of mine) {
        const [a, width] = place(interval);
        const middle = bbox.top + (lanes.indexOf(interval.key) * 1.25 + 0.5) * lane;
        ctx.strokeStyle = colourOf(interval.key)();
        ctx.lineWidth = lane;
        ctx.setLineDash(interval.kind === "oscillating" ? [6 * uPlot.pxRatio, 4 * uPlot.pxRatio] : []);
        ctx.beginPath();
        ctx.moveTo(a, middle);
        ctx.lineTo(a + width, middle);
        ctx.stroke();
      }
      ctx.restore();
    }

    const marker = make("div", "marker");
    function placeMarker() {
      const at = u.valToPos(clock.time / unit[1], "x");
      marker.style.transform = `translateX(${at}px)`;
      marker.hidden = !(at >= 0 && at <= u.bbox.width / uPlot.pxRatio);
    }
    function readValues() {
      const at = u.cursor.idx ?? (x.length ? u.valToIdx(clock.time / unit[1]) : null);
      curves.forEach(({ value }, i) => {
        const number = at === null ? null : u.data[i + 1][at];
        value.textContent = number === null ? "–" : show(number, { unit: yUnit, factor: 1, offset: 0 }, true);
      });
    }

    const tick = { stroke: () => css("--grid"), width: 1 };
    const look = { stroke: () => css("--muted"), font: FONT, grid: tick, ticks: { ...tick, size: 5 } };
    const numbers = (_, splits, __, ___, step) => {
      const whole = (d) => Math.abs(step * 10 ** d - Math.round(step * 10 ** d)) < 1e-6;
      const decimals = [0, 1, 2, 3, 4, 5].find(whole) ?? 6;
      return splits.map((v) => v.toFixed(decimals).replace("-", "−"));
    };
    const first = panel.series.filter((series) => series.shown);
    const u = new uPlot(
      {
        width: chart.clientWidth || 600,
        height: HEIGHT,
        legend: { show: false },
        focus: { alpha: 0.25 },
        cursor: {
          sync: { key: group.key, scales: ["x", null] },
          focus: { prox: 18 },
          points: { size: 7 },
          drag: { x: true, y: false },
          y: false,
        },
        scales: {
          x: { time: false },
          y: {
            range: (_, low, high) => {
              if (low === null || high === null) return [0, 1];
              const lack = Math.max(0, LEAST_SPAN[yUnit] - (high - low)) / 2;
              return uPlot.rangeNum(low - lack, high + lack, 0.08, true);
            },
          },
        },
        series: [{}, ...first.map(options)],
        axes: [
          { ...look, label: `Time, ${unit[2]}`, labelFont: FONT, labelSize: 20, size: 32, values: numbers },
          { ...look, label: axis, labelFont: FONT, labelSize: 20, size: 58, space: 34, values: numbers },
        ],
        hooks: {
          drawAxes: [() => curves.length && drawFlagged()],
          setCursor: [() => curves.length && readValues()],
          setScale: [(_, key) => key === "x" && curves.length && placeMarker()],
          setSize: [() => curves.length && placeMarker()],
          draw: [(self) => box.setAttribute("data-drawn", self.series.length - 1)],
        },
      },
      [x, ...first.map(values)],
      chart,
    );
    u.over.append(marker);
    for (const series of first) curves.push(chip(series));
    // A click without dragging sets the clock.
    let pressed = 0;
    u.over.addEventListener("pointerdown", (event) => (pressed = event.clientX));
    u.over.addEventListener("click", (event) => {
      if (Math.abs(event.clientX - pressed) > 3) return;
      const left = event.clientX - u.over.getBoundingClientRect().left;
      clock.setTime(u.posToVal(left, "x") * unit[1]);
    });

    function add(series) {
      if (!series || curves.some((curve) => curve.series === series)) return;
      const curve = chip(series);
      curves.push(curve);
      u.addSeries(options(series), curves.length);
      u.setData([...u.data, values(series)], false);
      u.redraw(true, true);
      readValues();
    }
    if (first.length < panel.series.length) {
      const label = make("label", "add", "Add ");
      const input = make("input");
      const list = make("datalist");
      list.id = `names-${panels.length}`;
      input.setAttribute("list", list.id);
      input.placeholder = `one of ${panel.series.length} series`;
      input.autocomplete = "off";
      for (const series of panel.series) {
        const option = make("option");
        option.value = series.name;
        list.append(option);
      }
      input.addEventListener("change", () => {
        const found = panel.series.find((series) => series.name === input.value.trim());
        if (!found) return;
        add(found);
        input.value = "";
      });
      label.append(input, list);
      top.append(label);
    }
    const resize = (width) => u.setSize({ width: width ?? chart.clientWidth, height: HEIGHT });
    new ResizeObserver(() => {
      if (!document.documentElement.classList.contains("printing") && chart.clientWidth) resize();
    }).observe(chart);
    clock.listen(() => {
      placeMarker();
      readValues();
    });
    panels.push({
      resize,
      redraw: () => u.redraw(false, true),
      addPlace: (key) => panel.series.filter((series) => series.key === key).forEach(add),
    });
    u.redraw(false, true);
  }

  for (const plot of data.plots) {
    const section = document.querySelector(`[data-plot="${plot.id}"]`);
    for (const panel of plot.panels) addPanel(section, plot, panel);
  }
  const redraw = () => panels.forEach((panel) => panel.redraw());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  const keys = new Set(data.plots.flatMap(({ panels }) => panels.flatMap(({ series }) => series.map((s) => s.key))));
  const add = (key) => panels.forEach((panel) => panel.addPlace(key));
  return {
    add,
    /** Curves of the place that a component belongs to. */
    addComponent(name) {
      for (let key = name; key; key = key.includes(".") ? key.slice(0, key.lastIndexOf(".")) : "") {
        if (keys.has(key)) return add(key);
      }
    },
    resize: (width) => panels.forEach((panel) => panel.resize(width)),
  };
}
