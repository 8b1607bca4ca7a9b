// The page of gnomon web: a day of sun on a model, from its baked intervals.

import { codeSeconds, intervalsAt, readBake } from "./bake_data.js";
import { falseColorGradient } from "./false_color.js";
import { View } from "./view.js";
import * as words from "./words.js";

const DAY_PLAYS_S = 24; // how long a whole path takes
const LONGEST_FRAME_MS = 250; // a page that was hidden goes on where it stopped
const KEY_STEP_S = 300;
const SLIDER_STEP_S = 60;
const LEAST_KEY_STEPS = 50; // in a path, however short
const LEAST_SLIDER_STEPS = 250;
const HOUR_S = 3600;
const TURN_RAD = Math.PI / 36; // of the camera, by a key: 5 degrees
const NEARER = 0.9; // of its distance
const EXACT_S = 2; // bakes whose times are as fine tell seconds
const CLICK_PX = 5; // a pointer that moves farther turns the camera
const TICKS = 5; // parts of the legend at most
const TICKS_EVERY_H = [1, 2, 3, 4, 6];

const by = (id) => document.getElementById(id);

const tell = (html) => {
  by("message").innerHTML = html;
  by("message").hidden = html === "";
};

class Page {
  constructor(bake, view) {
    this.bake = bake;
    this.view = view;
    this.time_s = 0.5 * (bake.begin_s + bake.end_s);
    const path_s = bake.end_s - bake.begin_s;
    this.keyStep_s = Math.min(KEY_STEP_S, path_s / LEAST_KEY_STEPS);
    this.clock = (time_s) => words.clock(time_s, path_s < HOUR_S);
    this.playing = false;
    this.showsHours = false;
    this.probe = null;
    this.most_s = Math.max(HOUR_S, Math.ceil(bake.most_sun_s / HOUR_S) * HOUR_S);
    this.fill();
    this.listen();
    this.setTime(this.time_s);
  }

  fill() {
    const { bake } = this;
    document.title = bake.title;
    by("title").textContent = bake.title;
    by("where").textContent = [words.place(bake.place), words.date(bake.date)].filter(Boolean).join(" · ");
    by("zone").textContent = bake.utc_offset ? `UTC${bake.utc_offset}` : "";
    by("begin").textContent = this.clock(bake.begin_s);
    by("end").textContent = this.clock(bake.end_s);
    const step = Math.min(SLIDER_STEP_S, (bake.end_s - bake.begin_s) / LEAST_SLIDER_STEPS);
    Object.assign(by("time"), { min: bake.begin_s, max: bake.end_s, step });
    by("legend-scale").style.background = falseColorGradient();
    const hours = this.most_s / HOUR_S;
    const every = TICKS_EVERY_H.find((n) => hours / n <= TICKS) ?? Math.ceil(hours / TICKS);
    for (let hour = 0; hour <= hours; hour += every) {
      const tick = document.createElement("span");
      tick.textContent = `${hour}${hour + every > hours ? " h" : ""}`;
      tick.style.left = `${(100 * hour) / hours}%`;
      by("legend-ticks").append(tick);
    }
  }

  listen() {
    by("time").addEventListener("input", () => this.setTime(Number(by("time").value)));
    by("play").addEventListener("click", () => this.play(!this.playing));
    by("hours").addEventListener("click", () => this.showHours(!this.showsHours));
    by("probe-close").addEventListener("click", () => this.ask(null));
    window.addEventListener("resize", () => this.view.resize());
    document.addEventListener("keydown", (event) => this.key(event));
    const canvas = this.view.canvas;
    let down = null;
    canvas.addEventListener("pointerdown", (event) => {
      down = event.isPrimary ? { x: event.clientX, y: event.clientY } : null;
    });
    canvas.addEventListener("pointerup", (event) => {
      if (!down || event.button !== 0) return;
      if (Math.hypot(event.clientX - down.x, event.clientY - down.y) > CLICK_PX) return;
      this.ask(this.view.pick(event.clientX, event.clientY));
    });
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const onButton = event.target instanceof HTMLButtonElement;
    const { canvas } = this.view;
    const turns = {
      ArrowLeft: () => this.view.turn(-TURN_RAD, 0),
      ArrowRight: () => this.view.turn(TURN_RAD, 0),
      ArrowUp: () => this.view.turn(0, TURN_RAD),
      ArrowDown: () => this.view.turn(0, -TURN_RAD),
    };
    const actions = {
      ArrowLeft: () => this.setTime(this.time_s - this.keyStep_s),
      ArrowRight: () => this.setTime(this.time_s + this.keyStep_s),
      " ": () => this.play(!this.playing),
      h: () => this.showHours(!this.showsHours),
      p: () => this.ask(this.view.pick(canvas.clientWidth >> 1, canvas.clientHeight >> 1)),
      "+": () => this.view.approach(NEARER),
      "=": () => this.view.approach(NEARER), // the key of + without Shift
      "-": () => this.view.approach(1 / NEARER),
      Escape: () => this.ask(null),
    };
    const action = (event.shiftKey && turns[event.key]) || actions[event.key];
    if (!action || (event.key === " " && onButton)) return; // a button presses itself
    event.preventDefault();
    action();
  }

  setTime(time_s) {
    const { begin_s, end_s } = this.bake;
    this.time_s = Math.min(Math.max(time_s, begin_s), end_s);
    this.view.setTime(this.time_s);
    const text = this.clock(this.time_s);
    by("time").value = this.time_s;
    by("time").setAttribute("aria-valuetext", text);
    by("clock").textContent = text;
  }

  play(on) {
    this.playing = on;
    by("play").setAttribute("aria-pressed", on);
    if (on && this.showsHours) this.showHours(false); // they stand still
  }

  showHours(on) {
    this.showsHours = on;
    by("hours").setAttribute("aria-pressed", on);
    by("legend").hidden = !on;
    if (on) this.play(false);
    this.view.showHours(on, this.most_s);
  }

  // Tells of the texel that a point shows, in words and on the slider's bar; null puts it away.
  ask(hit) {
    this.probe = hit;
    by("probe").hidden = hit === null;
    by("mark").hidden = hit === null;
    document.body.classList.toggle("probing", hit !== null);
    const spans = hit ? intervalsAt(this.bake, hit.page, hit.x, hit.y) : [];
    const { begin_s, end_s } = this.bake;
    const part = (time_s) => `${(100 * (time_s - begin_s)) / (end_s - begin_s)}%`;
    by("spans").replaceChildren(...spans.map(({ rise_s, fall_s }) => {
      const bar = document.createElement("i");
      bar.style.left = part(rise_s);
      bar.style.width = part(fall_s - rise_s + begin_s);
      return bar;
    }));
    this.view.stale = true;
    if (!hit) return;
    const code_s = codeSeconds(this.bake);
    const exact = code_s <= EXACT_S;
    const total_s = spans.reduce((sum, { rise_s, fall_s }) => sum + fall_s - rise_s, 0);
    by("probe-total").textContent = spans.length > 0 ? `${words.duration(total_s, exact)} of sun` : "No sun all day";
    by("probe-intervals").replaceChildren(...spans.map(({ rise_s, fall_s }) => {
      const line = document.createElement("li");
      const length = document.createElement("span");
      length.textContent = words.duration(fall_s - rise_s, exact);
      line.append(`${words.clock(rise_s, exact)} – ${words.clock(fall_s, exact)}`, length);
      return line;
    }));
    by("probe-note").textContent =
      spans.length > 0 && code_s >= 60 ? `Times in steps of ${words.duration(code_s)}` : "";
  }

  moveMark() {
    if (!this.probe) return;
    const at = this.view.project(this.probe.point_ws);
    by("mark").style.visibility = at ? "visible" : "hidden";
    if (at) by("mark").style.transform = `translate(${at.x}px, ${at.y}px)`;
  }

  run() {
    let last_ms = null;
    const tick = (now_ms) => {
      const { begin_s, end_s } = this.bake;
      if (this.playing && last_ms !== null) {
        const passed_s = Math.min(now_ms - last_ms, LONGEST_FRAME_MS) / 1000;
        const next_s = this.time_s + (passed_s / DAY_PLAYS_S) * (end_s - begin_s);
        this.setTime(next_s > end_s ? begin_s : next_s);
      }
      last_ms = now_ms;
      if (this.view.draw()) this.moveMark();
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }
}

const start = async () => {
  if (location.protocol === "file:") {
    tell(
      "Browsers do not let a page from disk read the files beside it. In this folder, run " +
        "<code>python3 -m http.server</code> and open <code>http://localhost:8000</code>.",
    );
    return;
  }
  if (!document.createElement("canvas").getContext("webgl2")) {
    tell("This browser or device has no WebGL 2, which the shadows are drawn with.");
    return;
  }
  try {
    const bake = await readBake();
    const view = new View(by("view"), bake);
    await view.load("scene.glb");
    const page = new Page(bake, view);
    document.body.classList.remove("loading");
    tell("");
    page.run();
    window.gnomon = { bake, view, page }; // for tests and the curious
  } catch (error) {
    tell("The model cannot be shown.");
    by("message").append(` ${error.message}`);
  }
};

start();
