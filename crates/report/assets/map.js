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

// Little to much, for what is neither cold nor hot.
const AMOUNT = [
  [108, 92, 160],
  [52, 116, 176],
  [32, 144, 140],
  [112, 168, 60],
  [226, 156, 24],
];
const STEPS = 32;
/** Flow below which water counts as resting, kg/s: as in the indicators. */
const RESTING = 1e-3;

/** The colours of a ramp as text, made once. */
function coloursOf(ramp) {
  return Array.from({ length: STEPS + 1 }, (_, step) => {
    const at = (step / STEPS) * (ramp.length - 1);
    const low = Math.min(Math.floor(at), ramp.length - 2);
    const mixed = ramp[low].map((c, i) => Math.round(c + (at - low) * (ramp[low + 1][i] - c)));
    return `rgb(${mixed.join(" ")})`;
  });
}

function startMap(data, clock, plots) {
  const svg = document.querySelector("svg[data-map]");
  const { vertices, edges, columns } = data.map;
  const steps = decode(data.map.data, Uint16Array);
  const low = decode(data.map.low, Float64Array);
  const size = decode(data.map.size, Float64Array);
  const { flow: FLOW, pressure: PRESSURE, temperature: TEMPERATURE, heat: HEAT, velocity: VELOCITY } = data.units;
  function valueAt(frame, column) {
    if (column === null) return NaN;
    const step = steps[frame * columns + column];
    return step === undefined || step === 65535 ? NaN : low[column] + step * size[column];
  }
  const at = (column) => valueAt(clock.index, column);
  const gap = Number(svg.dataset.gap);
  const brief = svg.classList.contains("brief");

  /** Least and greatest value of some columns over all frames. */
  function range(wanted) {
    const list = [...new Set(wanted)].filter((column) => column !== null);
    let [least, greatest] = [Infinity, -Infinity];
    for (let frame = 0; frame < clock.times.length; frame++) {
      for (const column of list) {
        const value = valueAt(frame, column);
        if (value < least) least = value;
        if (value > greatest) greatest = value;
      }
    }
    return [least, greatest];
  }
  const largest = (columns) => Math.max(0, ...range(columns).filter(Number.isFinite).map(Math.abs));
  const nodes = vertices.flatMap((vertex) => [vertex.hot, vertex.cold]).filter(Boolean);
  const flowMax = largest(edges.map((edge) => edge.flow));
  const speedOf = (edge, m) => (edge.area > 0 ? Math.abs(m) / (data.density_kg_m3 * edge.area) : NaN);
  document.getElementById("flow-max").textContent = show(flowMax, FLOW);

  // What colours show: values at both ends of a line, of a node, and their range, found when first asked for.
  const quantities = {
    temperature: {
      name: "Temperature",
      display: TEMPERATURE,
      ramp: coloursOf(RAMP),
      ends: endTemperatures,
      node: (node) => at(node.t),
      range: () => range([...nodes.map((node) => node.t), ...edges.flatMap((e) => [...e.inside, ...e.nodes])]),
      least: 2,
    },
    flow: {
      name: "Flow",
      display: FLOW,
      ramp: coloursOf(AMOUNT),
      ends: (edge) => [Math.abs(at(edge.flow)), Math.abs(at(edge.flow))],
      range: () => [0, flowMax],
      least: 0,
    },
    pressure: {
      name: "Pressure",
      display: PRESSURE,
      ramp: coloursOf(AMOUNT),
      ends: (edge) => edge.pressures.map(at),
      node: (node) => at(node.p),
      range: () => range([...nodes.map((node) => node.p), ...edges.flatMap((edge) => edge.pressures)]),
      least: 100,
    },
    velocity: {
      name: "Velocity",
      display: VELOCITY,
      ramp: coloursOf(AMOUNT),
      ends: (edge) => [speedOf(edge, at(edge.flow)), speedOf(edge, at(edge.flow))],
      range: () => [0, Math.max(0, ...edges.map((e) => speedOf(e, largest([e.flow]))).filter(Number.isFinite))],
      least: 0,
    },
  };
  let chosen = quantities.temperature;
  let [muted, blank] = [css("--muted"), css("--rule")];
  function choose(word) {
    chosen = quantities[word] ?? quantities.temperature;
    if (!chosen.scale) {
      const [least, greatest] = chosen.range();
      // One value only: the middle of the ramp.
      const lack = Math.max(0, chosen.least - (greatest - least)) / 2;
      chosen.scale = [least - lack, greatest + lack];
      chosen.shown = [least, greatest];
    }
    document.getElementById("c-name").textContent = chosen.name;
    document.getElementById("c-min").textContent = show(chosen.shown[0], chosen.display);
    document.getElementById("c-max").textContent = show(chosen.shown[1], chosen.display);
    document.getElementById("c-bar").style.background = `linear-gradient(to right, ${chosen.ramp.join(", ")})`;
    svg.dataset.quantity = word;
  }
  function colour(value) {
    const [least, greatest] = chosen.scale;
    const share = (value - least) / (greatest - least);
    if (!Number.isFinite(share)) return muted;
    return chosen.ramp[Math.round(Math.min(Math.max(share, 0), 1) * STEPS)];
  }

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
    const [a, b] = chosen.ends(edge);
    stops[0].setAttribute("stop-color", colour(a));
    stops[1].setAttribute("stop-color", colour(b));
    const m = at(edge.flow);
    const share = flowMax > 0 && Number.isFinite(m) ? Math.abs(m) / flowMax : 0;
    const width = gap * (0.14 + 0.5 * Math.sqrt(share));
    flow.setAttribute("stroke-width", width.toFixed(2));
    halo.setAttribute("stroke-width", (width + 0.2 * gap).toFixed(2));
    arrow.style.display = Math.abs(m) > RESTING ? "" : "none";
    arrow.setAttribute("fill", colour((a + b) / 2));
    arrow.setAttribute("transform", m < 0 ? "rotate(180)" : "");
  }

  function drawSite({ vertex, group, hot, cold, way, state }) {
    const fill = (node) => (node && chosen.node ? colour(chosen.node(node)) : blank);
    hot?.setAttribute("fill", fill(vertex.hot ?? vertex.cold));
    cold?.setAttribute("fill", fill(vertex.cold ?? vertex.hot));
    if (!vertex.stations.length) return;
    const flows = vertex.stations.map((station) => at(station.flow)).filter(Number.isFinite);
    const m = flows.length ? flows.reduce((sum, flow) => sum + flow, 0) : NaN;
    const idle = !(Math.abs(m) > RESTING);
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
    if (edge.area > 0) rows.push(["velocity", show(speedOf(edge, at(edge.flow)), VELOCITY)]);
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

  const look = startZoom(svg);
  startFind();
  function draw() {
    [muted, blank] = [css("--muted"), css("--rule")];
    lines.forEach(drawLine);
    sites.forEach(drawSite);
    fillTip();
    svg.dataset.frame = clock.index;
  }
  const select = document.getElementById("quantity");
  select.addEventListener("change", () => {
    choose(select.value);
    draw();
  });
  const speeds = edges.some((edge) => edge.area > 0);
  select.querySelector("[value=velocity]").disabled = !speeds;
  if (select.value === "velocity" && !speeds) select.value = "temperature";
  choose(select.value);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  clock.listen(draw);

  /** A name leads to its place: the map goes there, its curves are added. */
  function startFind() {
    const input = document.getElementById("find");
    const found = document.getElementById("found");
    const names = document.getElementById("places");
    for (const { vertex } of sites) names.appendChild(make("option")).value = vertex.name;
    let marked = null;
    input.addEventListener("change", () => {
      marked?.classList.remove("found");
      marked = null;
      const wanted = input.value.trim().toLowerCase();
      found.textContent = "";
      svg.dataset.found = "";
      if (!wanted) return;
      const by = (test) => sites.find(({ vertex }) => test(vertex.name)) ?? lines.find(({ edge }) => test(edge.id));
      const item =
        by((name) => name.toLowerCase() === wanted) ?? by((name) => name.toLowerCase().includes(wanted));
      if (!item) {
        found.textContent = "nothing has this name";
        return;
      }
      marked = item.group;
      marked.classList.add("found");
      const name = item.vertex ? item.vertex.name : item.edge.id;
      found.textContent = name;
      svg.dataset.found = name;
      const box = (item.vertex ? item.group : item.flow).getBBox();
      const shift = item.vertex ? item.group.transform.baseVal.consolidate().matrix : { e: 0, f: 0 };
      look(box.x + box.width / 2 + shift.e, box.y + box.height / 2 + shift.f);
      if (item.vertex) plots.add(name);
    });
  }
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
  /** Shows the surroundings of a point, at least as large as names need. */
  function look(x, y) {
    const share = Math.min(view.width / full.width, Math.max(1 / 40, Number(svg.dataset.font) / 11));
    const [width, height] = [full.width * share, full.height * share];
    view = { x: x - width / 2, y: y - height / 2, width, height };
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
  return look;
}
