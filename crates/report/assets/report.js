// Reads the embedded data, owns the clock, and starts map and plots.
// Names in the data are text of strangers: this script writes text and attributes, never markup.
"use strict";

/** Typed array of a base64 text. */
function decode(text, Type) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Type(bytes.buffer);
}

/** Value of a custom property of the current theme. */
function css(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** New element with class and text. */
function make(tag, className, text) {
  const element = document.createElement(tag);
  if (className) element.className = className;
  if (text !== undefined) element.textContent = text;
  return element;
}

const DECIMALS = { "l/min": 2, bar: 3, "°C": 1, kW: 2, "m/s": 3, "–": 2 };

/** A value in SI as text in its display unit; `bare` leaves the unit out. */
function show(si, display, bare) {
  if (si === null || si === undefined || !Number.isFinite(si)) return "–";
  const value = si * display.factor + display.offset;
  let decimals = DECIMALS[display.unit] ?? 2;
  if (Math.abs(value) >= 1000) decimals = Math.max(0, decimals - 2);
  let text = value.toFixed(decimals);
  if (Number(text) === 0) text = (0).toFixed(decimals);
  text = text.replace("-", "−");
  return bare || display.unit === "–" ? text : `${text} ${display.unit}`;
}

/** A time as text: `37 min 25 s`. */
function showTime(seconds) {
  if (!Number.isFinite(seconds)) return "–";
  const total = Math.round(Math.abs(seconds) * 1000) / 1000;
  const parts = [
    [Math.floor(total / 86400), "d"],
    [Math.floor(total / 3600) % 24, "h"],
    [Math.floor(total / 60) % 60, "min"],
    [Math.round((total % 60) * 1000) / 1000, "s"],
  ].filter(([value]) => value > 0);
  const text = parts.map(([value, unit]) => `${value} ${unit}`).join(" ") || "0 s";
  return seconds < 0 ? `−${text}` : text;
}

/** The moment that slider, map and plots show. */
function makeClock(times) {
  const listeners = [];
  const clock = {
    times,
    index: Math.max(0, times.length - 1),
    get time() {
      return times.length ? times[clock.index] : 0;
    },
    listen(listener) {
      listeners.push(listener);
    },
    set(index) {
      clock.index = Math.min(Math.max(0, Math.round(index)), Math.max(0, times.length - 1));
      for (const listener of listeners) listener();
    },
    setTime(time) {
      let low = 0;
      let high = times.length - 1;
      while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (times[middle] <= time + 1e-9) low = middle;
        else high = middle - 1;
      }
      const nextIsNearer = low + 1 < times.length && times[low + 1] - time < time - times[low];
      clock.set(nextIsNearer ? low + 1 : low);
    },
  };
  return clock;
}

/** Slider, play button, reading of the time. */
function startControls(data, clock) {
  const PLAY_MS = 20000;
  const slider = document.getElementById("time");
  const button = document.getElementById("play");
  const now = document.getElementById("now");
  let playing = false;
  let last = 0;
  let position = 0;

  function stop() {
    playing = false;
    button.classList.remove("playing");
    button.setAttribute("aria-label", "Play");
  }
  function step(stamp) {
    if (!playing) return;
    position += ((stamp - last) / PLAY_MS) * (clock.times.length - 1);
    last = stamp;
    if (Math.round(position) !== clock.index) clock.set(position);
    if (position >= clock.times.length - 1) stop();
    else requestAnimationFrame(step);
  }
  button.addEventListener("click", () => {
    if (playing) return stop();
    playing = true;
    button.classList.add("playing");
    button.setAttribute("aria-label", "Pause");
    position = clock.index >= clock.times.length - 1 ? 0 : clock.index;
    clock.set(position);
    last = performance.now();
    requestAnimationFrame(step);
  });
  slider.addEventListener("input", () => {
    stop();
    clock.set(Number(slider.value));
  });
  for (const link of document.querySelectorAll("button[data-time]")) {
    link.addEventListener("click", () => {
      stop();
      clock.setTime(Number(link.dataset.time));
      document.querySelector(".timed").scrollIntoView({ block: "start" });
    });
  }
  clock.listen(() => {
    if (!clock.times.length) return;
    slider.value = clock.index;
    let text = showTime(clock.time);
    slider.setAttribute("aria-valuetext", text);
    if (data.start_unix_ms !== null) {
      const date = new Date(data.start_unix_ms + clock.time * 1000);
      if (!Number.isNaN(date.getTime())) {
        text += ` · ${date.toISOString().slice(0, 19).replace("T", " ")} UTC`;
      }
    }
    now.textContent = text;
    document.getElementById("map-time").textContent = `State at ${text}`;
  });
}

/** The model file goes to the clipboard or into a file. */
function startModel() {
  const text = document.querySelector("pre[data-model]").textContent;
  const done = document.getElementById("model-done");
  document.getElementById("copy-model").addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(text);
      done.textContent = "copied";
    } catch {
      // Without the right to the clipboard the text is selected: the keyboard copies it.
      getSelection().selectAllChildren(document.querySelector("pre[data-model]"));
      done.textContent = "selected";
    }
  });
  document.getElementById("save-model").addEventListener("click", () => {
    const link = make("a");
    link.href = URL.createObjectURL(new Blob([text], { type: "application/toml" }));
    link.download = "model.toml";
    link.click();
    URL.revokeObjectURL(link.href);
  });
}

/** On paper: light colours, page width, details that belong there. */
function startPrinting(plots) {
  const root = document.documentElement;
  const kept = [...document.querySelectorAll("details[data-print]")];
  let before = [];
  window.addEventListener("beforeprint", () => {
    root.classList.add("printing");
    before = kept.map((element) => element.open);
    for (const element of kept) element.open = true;
    document.getElementById("zoom-all").click();
    plots.resize(660);
  });
  window.addEventListener("afterprint", () => {
    root.classList.remove("printing");
    kept.forEach((element, i) => (element.open = before[i]));
    plots.resize();
  });
}

function start() {
  const data = JSON.parse(document.getElementById("anergy-data").textContent);
  const clock = makeClock(decode(data.map.times, Float64Array));
  startControls(data, clock);
  const plots = startPlots(data, clock);
  startMap(data, clock, plots);
  startIndicators(data, plots);
  startModel();
  startPrinting(plots);
  clock.set(clock.index);
  document.body.dataset.ready = "1";
}

start();
