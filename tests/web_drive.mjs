// node tests/web_drive.mjs PACKAGES CHROMIUM URL FOLDER [picture]
//
// Uses the page of gnomon web at URL as a visitor would, in Chromium without a display or a GPU, and
// writes what it saw to FOLDER/seen.json and FOLDER/*.png; with `picture` the one for the
// documentation alone. PACKAGES: the folder with node_modules. tests/web_test.py judges.

import { writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const [packages, executablePath, url, folder, task] = process.argv.slice(2);
const { chromium } = createRequire(path.resolve(packages, "package.json"))("playwright-core");

const WIDE = { width: 1280, height: 720 };
const PHONE = { width: 360, height: 740 };
const GRID_PX = 16; // between the points asked for their texels
const HORIZON_S = 30;
const START_MS = 60000; // generous: software GL on a busy machine

const browser = await chromium.launch({
  executablePath,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const page = await browser.newPage({ viewport: WIDE });
const seen = { messages: [], requests: [] };
page.on("console", (message) => seen.messages.push(`${message.type()}: ${message.text()}`));
page.on("pageerror", (error) => seen.messages.push(`error: ${error.message}`));
page.on("request", (request) => seen.requests.push(request.url()));

// Two frames later all that was asked for is on the canvas.
const drawn = () =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
const shot = async (name) => {
  await drawn();
  await page.screenshot({ path: path.join(folder, `${name}.png`) });
};
const setTime = async (part) => {
  const time_s = await page.evaluate((p) => {
    const { begin_s, end_s } = window.gnomon.bake;
    return begin_s + p * (end_s - begin_s);
  }, part);
  await page.locator("#time").evaluate((slider, value) => {
    slider.value = value;
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  }, time_s);
  await drawn();
  return page.evaluate(() => window.gnomon.page.time_s);
};
const panel = () =>
  page.evaluate(() => ({
    hidden: document.getElementById("probe").hidden,
    total: document.getElementById("probe-total").textContent,
    intervals: [...document.querySelectorAll("#probe-intervals li")].map((li) => li.firstChild.textContent),
  }));
const state = () =>
  page.evaluate(() => ({
    time_s: window.gnomon.page.time_s,
    clock: document.getElementById("clock").textContent,
    playing: window.gnomon.page.playing,
    hours: !document.getElementById("legend").hidden,
    probe: !document.getElementById("probe").hidden,
    azimuth_deg: (180 / Math.PI) * window.gnomon.view.controls.getAzimuthalAngle(),
    polar_deg: (180 / Math.PI) * window.gnomon.view.controls.getPolarAngle(),
    distance_m: window.gnomon.view.controls.getDistance(),
  }));
const press = async (key) => {
  await page.keyboard.press(key);
  await drawn();
  return state();
};

const start = async () => {
  await page.goto(url);
  await page.waitForFunction(() => window.gnomon || document.body.innerText.includes("cannot be shown"), null, { timeout: START_MS });
};

const judge = async () => {
  seen.title = await page.title();
  seen.zone = await page.locator("#zone").innerText();
  seen.heading = await page.locator("header").innerText();
  seen.ticks = await page.evaluate(() =>
    [...document.getElementById("legend-ticks").children].map(({ textContent, style }) => [textContent, style.left]),
  );

  seen.times_s = [];
  for (const [name, part] of [["morning", 0.3], ["later", 0.36]]) {
    seen.times_s.push(await setTime(part));
    await shot(name);
  }
  const { begin_s, end_s, closed } = await page.evaluate(() => window.gnomon.bake);
  // Where the sun rises and sets, rounding tells whether the ground faces it.
  const inside_s = closed ? 0 : HORIZON_S;
  seen.visibility = [];
  for (const time_s of [...seen.times_s, begin_s + inside_s, begin_s + 120, end_s - inside_s]) {
    const text = await page.evaluate((time) => {
      window.gnomon.page.setTime(time);
      let characters = "";
      for (const byte of window.gnomon.view.visibilityBytes()) characters += String.fromCharCode(byte);
      return btoa(characters);
    }, time_s);
    const file = `visibility${seen.visibility.length}.bin`;
    writeFileSync(path.join(folder, file), Buffer.from(text, "base64"));
    seen.visibility.push({ time_s, file });
  }
  await page.evaluate((time) => window.gnomon.page.setTime(time), seen.times_s.at(-1));

  seen.points = await page.evaluate(({ WIDE, GRID_PX }) => {
    const points = [];
    for (let y = GRID_PX >> 1; y < WIDE.height; y += GRID_PX) {
      for (let x = GRID_PX >> 1; x < WIDE.width; x += GRID_PX) {
        const hit = window.gnomon.view.pick(x, y);
        if (hit) points.push({ x_px: x, y_px: y, page: hit.page, x: hit.x, y: hit.y });
      }
    }
    return points;
  }, { WIDE, GRID_PX });

  // Points beneath the panels cannot be clicked.
  const free = seen.points.filter(({ y_px }) => y_px > 280 && y_px < 600);
  seen.clicks = [];
  for (const point of free.filter((_, i) => i % 90 === 0)) {
    await page.mouse.click(point.x_px, point.y_px);
    seen.clicks.push({ ...point, ...(await panel()) });
  }

  seen.keys = { start: await state() };
  seen.keys.escape = await press("Escape");
  seen.keys.right = await press("ArrowRight");
  seen.keys.left = await press("ArrowLeft");
  seen.keys.hours = await press("h");
  await shot("hours");
  seen.keys.lit = await press("h");
  seen.keys.play = await press(" ");
  await page.waitForTimeout(500);
  seen.keys.pause = await press(" ");
  seen.keys.middle = await press("p");
  for (const key of ["Shift+ArrowLeft", "Shift+ArrowRight", "Shift+ArrowUp", "Shift+ArrowDown", "+", "-"]) {
    seen.keys[key] = await press(key);
  }
  await press("Shift+ArrowLeft");
  await shot("turned");
  await press("Shift+ArrowRight");

  await page.setViewportSize(PHONE);
  await press("h");
  await shot("phone");
  seen.phone = await page.evaluate(() => ({
    scrolls: document.documentElement.scrollWidth > window.innerWidth,
    boxes: ["controls", "play", "time", "hours", "probe", "legend", "title"].map((id) => {
      const { left, right, top, bottom } = document.getElementById(id).getBoundingClientRect();
      return { id, left, right, top, bottom };
    }),
  }));
};

const picture = async () => {
  await setTime(0.3);
  await page.mouse.click(560, 470);
  await shot("web");
};

try {
  await start();
  if (seen.messages.length === 0) await (task === "picture" ? picture() : judge());
} finally {
  writeFileSync(path.join(folder, "seen.json"), JSON.stringify(seen));
  await browser.close();
}
