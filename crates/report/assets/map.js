// Sets colours, arrows, texts and tooltips of the network map for the time of the clock.
"use strict";

// Cold to hot: blue over grey to red, which also colour-blind eyes tell apart.
const RAMP = [
  [33, 95, 168],
  [104, 160, 208],
  [190, 186, 184],
  [228, 134, 96],
  [190, 38, 44],
];

function rampColour(share) {
  if (!Number.isFinite(share)) return css("--muted");
  const at = Math.min(Math.max(share, 0), 1) * (RAMP.length - 1);
  const low = Math.min(Math.floor(at), RAMP.length - 2);
  const mixed = RAMP[low].map((c, i) => Math.round(c + (at - low) * (RAMP[low + 1][i] - c)));
  return `rgb(${mixed.join(" ")})`;
}

function startMap(data, clock, plots) {
  const svg = document.querySelector("svg[data-map]");
  const { vertices, edges, columns } = data.map;
  const values = decode(data.map.data, Float32Array);
  const { flow: FLOW, pressure: PRESSURE, temperature: TEMPERATURE, heat: HEAT } = data.units;
  const at = (column) => (column === null ? NaN : (values[clock.index * columns + column] ?? NaN));
  const gap = Number(svg.dataset.gap);
  const brief = svg.classList.contains("brief");

  /** Calls `visit` with every finite value of some columns. */
  function every(wanted, visit) {
    const list = [...new Set(wanted)].filter((column) => column !== null);
    for (let frame = 0; frame < clock.times.length; frame++) {
      for (const column of list) {
        const value = values[frame * columns + column];
        if (Number.isFinite(value)) visit(value);
      }
    }
  }
  let [tMin, tMax, flowMax, stationMax] = [Infinity, -Infinity, 0, 0];
  const nodes = vertices.flatMap((vertex) => [vertex.hot, vertex.cold]).filter(Boolean);
  const temperatures = edges.flatMap((edge) => [...edge.inside, ...edge.nodes]);
  every([...nodes.map((node) => node.t), ...temperatures], (t) => {
    tMin = Math.min(tMin, t);
    tMax = Math.max(tMax, t);
  });
  every(edges.map((edge) => edge.flow), (m) => (flowMax = Math.max(flowMax, Math.abs(m))));
  const stationFlows = vertices.flatMap((vertex) => vertex.stations.map((s) => s.flow));
  every(stationFlows, (m) => (stationMax = Math.max(stationMax, Math.abs(m))));
  document.getElementById("t-min").textContent = show(tMin, TEMPERATURE);
  document.getElementById("t-max").textContent = show(tMax, TEMPERATURE);
  document.getElementById("flow-max").textContent = show(flowMax, FLOW);
  // One temperature only: the middle of the ramp.
  if (tMax - tMin < 1) [tMin, tMax] = [(tMin + tMax - 1) / 2, (tMin + tMax + 1) / 2];
  const colour = (t) => rampColour((t - tMin) / (tMax - tMin));

  const intervals = new Map();
  for (const interval of data.flagged.filter(({ kind }) => kind === "blocked")) {
    if (!intervals.has(interval.component)) intervals.set(interval.component, []);
    intervals.get(interval.component).push(interval);
  }
  const blockedSince = (station) =>
    (intervals.get(station.id) ?? []).find(
      (i) => i.from <= clock.time && (i.to === null || clock.time < i.to),
    );

  /** Temperatures of the water at both ends: in the pipe, else of the node it comes from. */
  function endTemperatures(edge) {
    const inside = edge.inside.map(at);
    if (inside.every(Number.isFinite)) return inside;
    const [a, b] = edge.nodes.map(at);
    const m = at(edge.flow);
    if (m > 0) return [a, a];
    return m < 0 ? [b, b] : [a, b];
  }

  const lines = [...svg.querySelectorAll("[data-line]")].map((group, i) => ({
    edge: edges[i],
    group,
    stops: svg.querySelectorAll(`#g${i} stop`),
    flow: group.querySelector(".flow"),
    halo: group.querySelector(".halo"),
    arrow: group.querySelector(".arrow"),
  }));
  const sites = [...svg.querySelectorAll("[data-site]")].map((group, i) => ({
    vertex: vertices[i],
    group,
    hot: group.querySelector(".hot"),
    cold: group.querySelector(".cold"),
    way: group.querySelector(".way"),
    state: group.querySelector(".state"),
  }));

  function drawLine({ edge, stops, flow, halo, arrow }) {
    const [a, b] = endTemperatures(edge);
    stops[0].setAttribute("stop-color", colour(a));
    stops[1].setAttribute("stop-color", colour(b));
    const m = at(edge.flow);
    const share = flowMax > 0 && Number.isFinite(m) ? Math.abs(m) / flowMax : 0;
    const width = gap * (0.14 + 0.5 * Math.sqrt(share));
    flow.setAttribute("stroke-width", width.toFixed(2));
    halo.setAttribute("stroke-width", (width + 0.2 * gap).toFixed(2));
    arrow.style.display = share < 0.002 ? "none" : "";
    arrow.setAttribute("fill", colour((a + b) / 2));
    arrow.setAttribute("transform", m < 0 ? "rotate(180)" : "");
  }

  function drawSite({ vertex, group, hot, cold, way, state }) {
    const t = (node) => colour(node ? at(node.t) : NaN);
    hot?.setAttribute("fill", t(vertex.hot ?? vertex.cold));
    cold?.setAttribute("fill", t(vertex.cold ?? vertex.hot));
    if (!vertex.stations.length) return;
    const flows = vertex.stations.map((station) => at(station.flow)).filter(Number.isFinite);
    const m = flows.length ? flows.reduce((sum, flow) => sum + flow, 0) : NaN;
    const idle = !(Math.abs(m) > 0.002 * stationMax);
    const blocked = vertex.stations.some(blockedSince);
    group.classList.toggle("idle", idle);
    group.classList.toggle("blocked", blocked);
    way.setAttribute("transform", m < 0 ? "rotate(180)" : "");
    const word = brief ? "" : m > 0 ? "feeds in " : "extracts ";
    const text = Number.isNaN(m) ? "–" : idle ? "idle" : word + show(Math.abs(m), FLOW);
    state.textContent = blocked ? `blocked${brief ? "" : ` · ${show(m, FLOW)}`}` : text;
  }

  function siteTip(vertex) {
    const rows = [];
    for (const [side, node] of [["hot", vertex.hot], ["cold", vertex.cold]]) {
      if (!node) continue;
      const name = vertex.cold ? side : "node";
      rows.push([name, `${show(at(node.t), TEMPERATURE)}, ${show(at(node.p), PRESSURE)}`]);
    }
    if (vertex.hot && vertex.cold) {
      rows.push(["hot − cold", show(at(vertex.hot.p) - at(vertex.cold.p), PRESSURE)]);
    }
    for (const station of vertex.stations) {
      if (vertex.stations.length > 1) rows.push([station.id, ""]);
      rows.push(["flow", show(at(station.flow), FLOW)]);
      if (station.requested !== null) rows.push(["requested", show(at(station.requested), FLOW)]);
      if (station.heat !== null) rows.push(["heat", show(at(station.heat), HEAT)]);
      const blocked = blockedSince(station);
      if (blocked) rows.push(["blocked", `since ${showTime(blocked.from)}`]);
    }
    return [vertex.name, rows];
  }

  function lineTip(edge) {
    const size = edge.length > 0 ? `, ${Number(edge.length.toPrecision(4))} m` : "";
    const rows = [["kind", edge.kind.replaceAll("_", " ") + size], ["flow", show(at(edge.flow), FLOW)]];
    const [a, b] = endTemperatures(edge).map((t) => show(t, TEMPERATURE));
    rows.push(["at a, at b", `${a}, ${b}`]);
    if (edge.dp !== null) rows.push(["pressure a − b", show(at(edge.dp), PRESSURE)]);
    if (edge.loss !== null) rows.push(["heat loss", show(at(edge.loss), HEAT)]);
    if (edge.speed !== null) rows.push(["speed", show(at(edge.speed), { unit: "–", factor: 1, offset: 0 })]);
    if (edge.opening !== null) rows.push(["opening", show(at(edge.opening), { unit: "–", factor: 1, offset: 0 })]);
    return [edge.id, rows];
  }

  // Tooltips: the element under the pointer or with the focus; arrow keys walk from symbol to symbol.
  const tip = document.getElementById("tip");
  const items = [
    ...sites.map(({ group, vertex }) => ({ group, text: () => siteTip(vertex), name: vertex.name })),
    ...lines.map(({ group, edge }) => ({ group, text: () => lineTip(edge) })),
  ];
  let shown = null;
  function fillTip() {
    if (!shown) return;
    const [name, rows] = shown.text();
    const list = make("dl");
    for (const [label, value] of rows) list.append(make("dt", "", label), make("dd", "", value));
    tip.replaceChildren(make("strong", "", name), list);
    const words = rows.map(([label, value]) => `${label} ${value}`).join("; ");
    shown.group.setAttribute("aria-label", `${name}: ${words}`);
  }
  function showTip(item) {
    shown = item;
    tip.hidden = !item;
    if (!item) return;
    fillTip();
    const box = item.group.getBoundingClientRect();
    const left = box.left + box.width / 2 - tip.offsetWidth / 2;
    const below = box.bottom + 10 + tip.offsetHeight < window.innerHeight;
    const top = below ? box.bottom + 8 : Math.max(4, box.top - tip.offsetHeight - 8);
    const limit = document.documentElement.clientWidth - tip.offsetWidth - 8;
    tip.style.left = `${Math.max(8, Math.min(left, limit))}px`;
    tip.style.top = `${Math.min(top, window.innerHeight - tip.offsetHeight - 8)}px`;
  }
  items.forEach((item, i) => {
    const { group } = item;
    group.addEventListener("pointerenter", () => showTip(item));
    group.addEventListener("pointerleave", () => showTip(null));
    group.addEventListener("focus", () => group.matches(":focus-visible") && showTip(item));
    group.addEventListener("blur", () => showTip(null));
    group.addEventListener("click", () => item.name !== undefined && plots.add(item.name));
    group.addEventListener("keydown", (event) => {
      const move = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
      if (event.key === "Escape") showTip(null);
      if (event.key === "Enter" && item.name !== undefined) plots.add(item.name);
      if (!move) return;
      event.preventDefault();
      const next = items[(i + move + items.length) % items.length].group;
      group.setAttribute("tabindex", "-1");
      next.setAttribute("tabindex", "0");
      next.focus({ preventScroll: true, focusVisible: true });
    });
  });
  window.addEventListener("scroll", () => showTip(null), { passive: true });

  startZoom(svg);
  clock.listen(() => {
    lines.forEach(drawLine);
    sites.forEach(drawSite);
    fillTip();
    svg.dataset.frame = clock.index;
  });
}

/** Buttons, ctrl + wheel and dragging change the part of the map that is seen. */
function startZoom(svg) {
  const all = svg.viewBox.baseVal;
  const full = { x: all.x, y: all.y, width: all.width, height: all.height };
  let view = { ...full };
  function apply() {
    view.x = Math.min(Math.max(view.x, full.x), full.x + full.width - view.width);
    view.y = Math.min(Math.max(view.y, full.y), full.y + full.height - view.height);
    svg.setAttribute("viewBox", `${view.x} ${view.y} ${view.width} ${view.height}`);
    const pixels = (Number(svg.dataset.font) * svg.clientWidth) / view.width;
    svg.classList.toggle("zoomed", pixels > 7.5);
    svg.classList.toggle("movable", view.width < full.width);
  }
  function zoom(factor, fx = 0.5, fy = 0.5) {
    const share = Math.min(1, Math.max(1 / 40, (view.width / full.width) * factor));
    const [width, height] = [full.width * share, full.height * share];
    view = {
      x: view.x + (view.width - width) * fx,
      y: view.y + (view.height - height) * fy,
      width,
      height,
    };
    apply();
  }
  document.getElementById("zoom-in").addEventListener("click", () => zoom(1 / 1.5));
  document.getElementById("zoom-out").addEventListener("click", () => zoom(1.5));
  document.getElementById("zoom-all").addEventListener("click", () => zoom(Infinity));
  svg.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    const box = svg.getBoundingClientRect();
    const share = (value, start, size) => (value - start) / size;
    zoom(
      Math.exp(event.deltaY / 300),
      share(event.clientX, box.left, box.width),
      share(event.clientY, box.top, box.height),
    );
  }, { passive: false });
  let held = null;
  svg.addEventListener("pointerdown", (event) => (held = [event.clientX, event.clientY]));
  window.addEventListener("pointerup", () => (held = null));
  window.addEventListener("pointermove", (event) => {
    if (!held || view.width >= full.width) return;
    const scale = view.width / svg.getBoundingClientRect().width;
    view.x -= (event.clientX - held[0]) * scale;
    view.y -= (event.clientY - held[1]) * scale;
    held = [event.clientX, event.clientY];
    apply();
  });
}
