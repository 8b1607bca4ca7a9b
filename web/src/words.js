// Numbers as people read them.

const MINUTE_S = 60;
const HOUR_S = 3600;
const DAY_S = 86400;

const two = (n) => String(n).padStart(2, "0");

// "09:05"; with seconds "09:05:07".
export const clock = (time_s, seconds = false) => {
  const unit_s = seconds ? 1 : MINUTE_S;
  const day = DAY_S / unit_s;
  const rest_s = (((Math.round(time_s / unit_s) % day) + day) % day) * unit_s;
  const parts = [Math.floor(rest_s / HOUR_S), Math.floor(rest_s / MINUTE_S) % 60];
  return (seconds ? [...parts, rest_s % MINUTE_S] : parts).map(two).join(":");
};

// "2 h 5 min"; with seconds "2 h 5 min 7 s".
export const duration = (span_s, seconds = false) => {
  const unit_s = seconds ? 1 : MINUTE_S;
  const rest_s = Math.round(span_s / unit_s) * unit_s;
  const parts = [[Math.floor(rest_s / HOUR_S), "h"], [Math.floor(rest_s / MINUTE_S) % 60, "min"]];
  if (seconds) parts.push([rest_s % MINUTE_S, "s"]);
  const told = parts.filter(([n]) => n > 0);
  return (told.length > 0 ? told : parts.slice(-1)).map(([n, unit]) => `${n} ${unit}`).join(" ");
};

// "48.137,11.575" as 48.137° N, 11.575° E; anything else as it stands.
export const place = (text) => {
  const numbers = text.split(",").map(Number);
  if (text === "" || numbers.length < 2 || numbers.some(Number.isNaN)) return text;
  const [latitude, longitude] = numbers;
  return (
    `${Math.abs(latitude)}° ${latitude < 0 ? "S" : "N"}, ` +
    `${Math.abs(longitude)}° ${longitude < 0 ? "W" : "E"}`
  );
};

// "2026-06-21" as 21 June 2026.
export const date = (text) => {
  const day = new Date(`${text}T00:00:00Z`);
  if (Number.isNaN(day.getTime())) return text;
  return day.toLocaleDateString("en-GB", { day: "numeric", month: "long", year: "numeric", timeZone: "UTC" });
};
