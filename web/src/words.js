// Numbers as people read them.

const MINUTE_S = 60;

export const clock = (time_s) => {
  const minutes = ((Math.round(time_s / MINUTE_S) % 1440) + 1440) % 1440;
  return [Math.floor(minutes / 60), minutes % 60].map((n) => String(n).padStart(2, "0")).join(":");
};

export const duration = (span_s) => {
  const minutes = Math.round(span_s / MINUTE_S);
  const [hours, rest] = [Math.floor(minutes / 60), minutes % 60];
  if (hours === 0) return `${rest} min`;
  return rest === 0 ? `${hours} h` : `${hours} h ${rest} min`;
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
