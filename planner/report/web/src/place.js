/**
 * The moment and the camera that the address names, "#t=12.5&step=7&camera=x,y,z,to x,y,z&run=1": seconds on the run's clock (without
 * a clock, the step), of several steps that end then which one, and where the camera is and looks [m]. What is missing or no
 * number is left as it is.
 */
export function readPlace(hash) {
  const words = new URLSearchParams(hash.replace(/^#/, "")), number = (name) => {
    const text = words.get(name), value = Number(text);
    return text !== null && text.trim() !== "" && Number.isFinite(value) ? value : null;
  };
  const camera = (words.get("camera") ?? "").split(",").map(Number);
  return { time: number("t"), step: number("step"), run: number("run"), camera: camera.length === 6 && camera.every(Number.isFinite) ? camera : null };
}

/** @param step that ends at the time; null if none does */
export function placeText({ time, step, run, camera }) {
  const short = (value) => String(Number(value.toFixed(3)));
  return [`#t=${time}`, ...(step === null ? [] : [`step=${step}`]), ...(run > 0 ? [`run=${run}`] : []), ...(camera ? [`camera=${camera.map(short).join(",")}`] : [])].join("&");
}
