// What gnomon web wrote: web.json, and of each page a texture array of numbers. docs/bakes.md tells
// of the files.

const LANES = 4; // intervals per pair of textures

const fetched = async (name) => {
  const response = await fetch(name);
  if (!response.ok) throw new Error(`${name}: the server answers ${response.status}`);
  return response;
};

const readPage = async (bake, page) => {
  const buffer = await (await fetched(page.file)).arrayBuffer();
  const numbers = bake.bits === 8 ? new Uint8Array(buffer) : new Uint16Array(buffer);
  const wanted = page.side_texels ** 2 * LANES * 2 * page.pairs;
  if (numbers.length !== wanted) {
    throw new Error(`${page.file}: holds ${numbers.length} numbers, not ${wanted}`);
  }
  return { side: page.side_texels, pairs: page.pairs, layers: 2 * page.pairs, numbers };
};

export const readBake = async () => {
  const bake = await (await fetched("web.json")).json();
  const pages = await Promise.all(bake.pages.map((page) => readPage(bake, page)));
  return { ...bake, pages };
};

export const steps = (bake) => bake.to_light_ws.length;

export const codeSeconds = (bake) =>
  (bake.end_s - bake.begin_s) / (steps(bake) * bake.codes_per_step);

// Along the path, 0 to steps.
export const stepAt = (bake, time_s) =>
  ((time_s - bake.begin_s) / (bake.end_s - bake.begin_s)) * steps(bake);

// Towards the light; step k's direction is that of its middle, k + 0.5. Beyond the first and the last
// middle it goes on as it came.
export const toLightAt = (bake, time_s) => {
  const last = steps(bake) - 1;
  const at = stepAt(bake, time_s) - 0.5;
  const first = Math.min(Math.max(Math.floor(at), 0), Math.max(last - 1, 0));
  const [a, b] = [bake.to_light_ws[first], bake.to_light_ws[Math.min(first + 1, last)]];
  const mixed = a.map((value, i) => value + (at - first) * (b[i] - value));
  const length = Math.hypot(...mixed);
  return mixed.map((value) => value / length);
};

// The spans of clock time in which a texel sees the light, in order: [{ rise_s, fall_s }].
export const intervalsAt = (bake, page, x, y) => {
  const { side, pairs, numbers } = bake.pages[page];
  const found = [];
  for (let pair = 0; pair < pairs; ++pair) {
    for (let lane = 0; lane < LANES; ++lane) {
      const value = (layer) => numbers[((layer * side + y) * side + x) * LANES + lane];
      const [rise, fall] = [value(2 * pair), value(2 * pair + 1)];
      if (fall <= rise) continue;
      const clock = (code) => bake.begin_s + code * codeSeconds(bake);
      found.push({ rise_s: clock(rise), fall_s: clock(fall) });
    }
  }
  return found;
};
