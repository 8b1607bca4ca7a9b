"use strict";
// The page is whole without this script; it adds sorting, the wipe, the loupe and the inspector.
document.documentElement.classList.add("js");

// Sorting: each heading becomes a button. Rows without a value stay last.
for (const table of document.querySelectorAll("table.summary")) {
  const body = table.tBodies[0];
  const headings = [...table.tHead.rows[0].cells];

  const key = (row, column) => {
    const cell = row.cells[column];
    if (!cell || cell.classList.contains("reason")) return null;
    return "value" in cell.dataset ? Number(cell.dataset.value) : cell.textContent.trim();
  };
  const compare = (a, b) => (typeof a === "number" ? a - b : a.localeCompare(b));

  const sort = (column) => {
    const heading = headings[column];
    const descending = heading.getAttribute("aria-sort") === "ascending";
    for (const other of headings) other.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", descending ? "descending" : "ascending");
    const rows = [...body.rows].map((row) => ({ row, value: key(row, column) }));
    rows.sort((a, b) => {
      if (a.value === null || b.value === null) return (a.value === null) - (b.value === null);
      return descending ? compare(b.value, a.value) : compare(a.value, b.value);
    });
    body.append(...rows.map((entry) => entry.row));
  };

  headings.forEach((heading, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...heading.childNodes);
    button.addEventListener("click", () => sort(column));
    heading.append(button);
  });
}

// The wipe: both sliders of a row move together, so that picture and visibility show one place.
const describe = (slider) =>
  slider.setAttribute("aria-valuetext", `${Math.round(slider.value)} % truth`);

for (const row of document.querySelectorAll(".result")) {
  const sliders = row.querySelectorAll(".wipe");
  for (const slider of sliders) {
    describe(slider);
    slider.addEventListener("input", () => {
      row.style.setProperty("--wipe", `${slider.value}%`);
      row.style.setProperty("--wiping", slider.value > 0 ? 1 : 0);
      for (const other of sliders) {
        other.value = slider.value;
        describe(other);
      }
    });
  }
}

// The loupe: pointing at one picture enlarges the same pixels of all pictures in its row.
const imagesOf = (frame) => ({
  base: frame.querySelector("img:not(.truth)"),
  truth: frame.querySelector("img.truth"),
});

const kLoupePixels = 96;
const kLoupeZoom = 8;

const loupePane = (image, u, v, label) => {
  const pane = document.createElement("span");
  const width = Number(image.getAttribute("width"));
  const height = Number(image.getAttribute("height"));
  const x = kLoupePixels / 2 - (Math.floor(u * width) + 0.5) * kLoupeZoom;
  const y = kLoupePixels / 2 - (Math.floor(v * height) + 0.5) * kLoupeZoom;
  pane.style.backgroundImage = `url("${image.getAttribute("src")}")`;
  pane.style.backgroundSize = `${width * kLoupeZoom}px ${height * kLoupeZoom}px`;
  pane.style.backgroundPosition = `${x}px ${y}px`;
  pane.dataset.label = label;
  return pane;
};

const removeLoupes = (row) => row.querySelectorAll(".loupe, .spot").forEach((part) => part.remove());

const showLoupes = (row, u, v) => {
  removeLoupes(row);
  for (const frame of row.querySelectorAll(".frame")) {
    const { base, truth } = imagesOf(frame);
    const loupe = document.createElement("span");
    loupe.className = u > 0.5 ? "loupe left" : "loupe";
    if (truth) loupe.append(loupePane(truth, u, v, "truth"));
    loupe.append(loupePane(base, u, v, truth ? "technique" : frame.dataset.view));
    const spot = document.createElement("span");
    spot.className = "spot";
    spot.style.left = `${100 * u}%`;
    spot.style.top = `${100 * v}%`;
    frame.append(spot, loupe);
  }
};

const placeIn = (box, event) => ({
  u: Math.min(Math.max((event.clientX - box.left) / box.width, 0), 0.9999),
  v: Math.min(Math.max((event.clientY - box.top) / box.height, 0), 0.9999),
});

for (const row of document.querySelectorAll(".row")) {
  for (const frame of row.querySelectorAll(".frame")) {
    frame.addEventListener("pointermove", (event) => {
      if (event.pointerType !== "mouse") return;
      const { u, v } = placeIn(frame.getBoundingClientRect(), event);
      showLoupes(row, u, v);
    });
    frame.addEventListener("pointerleave", () => removeLoupes(row));
    frame.addEventListener("click", (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;  // a new tab, as for any link
      event.preventDefault();
      // A key press has no place: it opens the middle.
      const place = event.detail > 0 ? placeIn(frame.getBoundingClientRect(), event) : { u: 0.5, v: 0.5 };
      inspect(row, frame.dataset.view, place);
    });
  }
}

// The inspector: one picture, pixel for pixel.
const inspector = document.getElementById("inspector");
const viewport = inspector.querySelector(".viewport");
const stage = inspector.querySelector(".stage");
const stageBase = stage.querySelector(".base");
const stageTruth = stage.querySelector(".truth");
const wipeLabel = inspector.querySelector(".inspector-wipe");
const wipe = wipeLabel.querySelector("input");
const radios = (name) => [...inspector.querySelectorAll(`input[name="${name}"]`)];
let inspectedRow = null;

const wipeStage = () => {
  // The slider spans the viewport, not the picture, which may be larger or smaller.
  const edge = viewport.getBoundingClientRect().left - stage.getBoundingClientRect().left;
  const cut = edge + viewport.clientWidth * (wipe.value / 100);
  const width = stage.clientWidth;
  stage.style.setProperty("--cut", `${Math.min(Math.max(cut, 0), width)}px`);
  stage.style.setProperty("--wiping", !stageTruth.hidden && cut > 0 && cut < width ? 1 : 0);
  describe(wipe);
};

const center = () => ({
  u: (viewport.scrollLeft + viewport.clientWidth / 2) / Math.max(viewport.scrollWidth, 1),
  v: (viewport.scrollTop + viewport.clientHeight / 2) / Math.max(viewport.scrollHeight, 1),
});

const setZoom = (zoom, { u, v }) => {
  const width = Number(stageBase.dataset.width);
  const height = Number(stageBase.dataset.height);
  const fit = Math.min(viewport.clientWidth / width, viewport.clientHeight / height);
  // At 1x a pixel of the picture is one of the screen, also where the browser scales pages.
  const scale = zoom === "fit" ? fit : Number(zoom) / window.devicePixelRatio;
  stage.style.width = `${width * scale}px`;
  stage.style.height = `${height * scale}px`;
  viewport.scrollLeft = u * viewport.scrollWidth - viewport.clientWidth / 2;
  viewport.scrollTop = v * viewport.scrollHeight - viewport.clientHeight / 2;
  wipeStage();
};

const setView = (view) => {
  const { base, truth } = imagesOf(inspectedRow.querySelector(`.frame[data-view="${view}"]`));
  stageBase.src = base.src;
  stageBase.alt = base.alt;
  stageBase.dataset.width = base.getAttribute("width");
  stageBase.dataset.height = base.getAttribute("height");
  stageTruth.hidden = wipeLabel.hidden = !truth;
  inspector.querySelector(".scale").hidden = view !== "difference";
  if (truth) stageTruth.src = truth.src;
};

const checked = (name) => radios(name).find((radio) => radio.checked).value;
const check = (name, value) => {
  for (const radio of radios(name)) radio.checked = radio.value === value;
};

const inspect = (row, view, place) => {
  inspectedRow = row;
  removeLoupes(row);
  inspector.querySelector("h2").textContent = row.dataset.title;
  for (const radio of radios("view")) {
    radio.disabled = !row.querySelector(`.frame[data-view="${radio.value}"]`);
  }
  check("view", view);
  check("zoom", "4");
  wipe.value = 0;
  inspector.showModal();
  setView(view);
  setZoom("4", place);
  viewport.focus();
};

for (const radio of radios("view")) {
  radio.addEventListener("change", () => {
    setView(radio.value);
    wipeStage();
  });
}
for (const radio of radios("zoom")) {
  radio.addEventListener("change", () => setZoom(radio.value, center()));
}
wipe.addEventListener("input", wipeStage);
viewport.addEventListener("scroll", wipeStage);
window.addEventListener("resize", () => {
  if (inspector.open) setZoom(checked("zoom"), center());
});
inspector.querySelector(".close").addEventListener("click", () => inspector.close());

viewport.addEventListener("pointermove", (event) => {
  if (event.pointerType !== "mouse" || event.buttons !== 1) return;
  viewport.scrollLeft -= event.movementX;
  viewport.scrollTop -= event.movementY;
});
stage.addEventListener("dragstart", (event) => event.preventDefault());
