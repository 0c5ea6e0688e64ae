// The replay of a report: its time line, layers and clicks; what is drawn, voxel by voxel.
import assert from "node:assert/strict";
import { near } from "./number_checks.mjs";
import { lookOf } from "./open_report.mjs";

export async function timeLineWorks(page, rows) {
  const times = [...new Map(rows.map((row) => [row.step, row.time_s])).values()], last = times.length - 1;
  const label = () => page.textContent("#step-label"), seconds = (time) => `${time.toFixed(1)} s`;
  const says = async (step, what) => assert.ok((await label()).startsWith(`${times[step].toFixed(1)} of ${seconds(times[last])} · step ${step} of ${last} · `), `${what ?? step}: ${await label()}`);
  await says(last, "begins at the end");
  await page.keyboard.press("Home");
  await says(0);
  await page.keyboard.press("ArrowRight");
  await says(1);
  await page.click("#forward");
  await says(2);
  await page.click("#back");
  await page.click("#back");
  await says(0);
  await page.click("#last");
  await says(last);
  await page.locator("#time").fill("3");
  await says(3);
  assert.equal(await page.getAttribute("#time", "aria-valuetext"), await label());
  // It plays by the clock.
  await page.selectOption("#speed", "10");
  await page.locator("#view canvas").focus();
  await page.keyboard.press("Space");
  const [from, began] = await page.evaluate(() => [window.frontlux.page.timeline.time, performance.now()]);
  await page.waitForFunction(() => window.frontlux.page.timeline.step >= 5);
  const [to, ended] = await page.evaluate(() => [window.frontlux.page.timeline.time, performance.now()]);
  const speed = (1000 * (to - from)) / (ended - began);
  assert.ok(speed > 5 && speed < 15, `${speed} seconds of the run in a second, instead of 10`);
  assert.equal(await page.getAttribute("#play", "aria-label"), "Pause (space)");
  await page.keyboard.press("Space");
  const paused = await label();
  await page.waitForTimeout(600);
  assert.equal(await label(), paused, "it goes on although it was paused");
  const mark = () => page.evaluate(() => document.querySelector("#chart-coverage .chart-mark").style.transform);
  const before = await mark();
  await page.keyboard.press("Home");
  assert.notEqual(await mark(), before, "the charts' line stays behind");
  // A click in a chart goes to the step that is nearest.
  const box = await page.locator("#chart-coverage .u-over").boundingBox();
  await page.mouse.click(box.x + box.width * 0.5, box.y + box.height / 2);
  const middle = await page.evaluate(() => window.frontlux.page.timeline.step);
  const away = (step) => Math.abs(times[step] - times[last] / 2);
  assert.ok(times.every((_, step) => away(middle) <= away(step) + 0.02 * times[last]), `a click in the middle went to ${middle}`);
}

export async function layersWork(page) {
  await page.keyboard.press("End");
  const look = () => lookOf(page);
  await page.evaluate(() => (document.querySelector("#view canvas").style.outline = "none")); // the focus is no layer
  await page.evaluate(() => window.frontlux.page.timeline.seek(2));
  const names = await page.evaluate(() => [...document.querySelectorAll(".layers input")].map((box) => box.id.replace("layer-", "")));
  assert.equal(names.length, 8, "without tours there is no layer for them");
  const all = await look();
  for (const [i, name] of names.entries()) {
    await page.locator(`#layer-${name}`).uncheck();
    assert.notEqual(await look(), all, `${name} off looks the same`);
    await page.locator("#view canvas").focus();
    await page.keyboard.press(String(i + 1));
    assert.equal(await page.isChecked(`#layer-${name}`), true, `key ${i + 1} is not for ${name}`);
    assert.equal(await look(), all, `${name} on again looks different`);
  }
  await page.selectOption("#sensor", "1");
  assert.notEqual(await look(), all, "the camera's view is not shown");
  assert.match(await page.textContent(".sensor-view"), /: ahead, 10 m/);
  await page.selectOption("#sensor", "0");
  await look();
  assert.match(await page.textContent(".sensor-view"), /: all around, ahead in the middle, 6 m/);
  await page.selectOption("#sensor", "-1");
  assert.equal(await look(), all, "the sensor's view stays");
  await page.selectOption("#colors", "owner");
  assert.notEqual(await look(), all, "colours by robot look like heights");
  await page.selectOption("#colors", "height");
  await page.locator("#cut").fill("4");
  const cut = await look();
  assert.notEqual(cut, all, "the cut hides nothing");
  await page.locator("#cut").fill(await page.getAttribute("#cut", "max"));
  assert.equal(await look(), all, "without the cut it looks different");
  await page.selectOption("#follow", "0");
  assert.notEqual(await look(), all, "following looks like not following");
  await page.click("#view-top");
  assert.notEqual(await look(), all);
  await page.click("#view-home");
  assert.equal(await look(), all);
}

/** What is drawn, compared with the map voxel by voxel: in the page, where both are. */
export async function voxelsAreRight(page, rows) {
  const steps = await page.evaluate(() => window.frontlux.page.run.steps);
  for (const step of [0, 3, steps - 1, 1]) {
    const { drawn, faces, frontiers, found, parts } = await page.evaluate((s) => {
      const { page: { scene, timeline, run } } = window.frontlux, { store, voxels } = scene;
      timeline.seek(s);
      const state = (...key) => store.at(...key) & 3, sides = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
      const out = { drawn: 0, faces: 0, found: 0, frontiers: voxels.countFrontiers(), parts: run.facts.robots.map(() => 0) };
      const [low, high] = run.facts.bounds;
      for (let x = low[0] - 1; x <= high[0] + 1; ++x)
        for (let y = low[1] - 1; y <= high[1] + 1; ++y)
          for (let z = low[2] - 1; z <= high[2] + 1; ++z) {
            const here = state(x, y, z), free = sides.filter(([a, b, c]) => state(x + a, y + b, z + c) === 1).length;
            if (here === 2) out.faces += free;
            const inside = [x, y, z].every((k, i) => k >= low[i] && k <= high[i]);
            if (here === 0 && free > 0 && inside) ++out.found;
            if (here !== 0) ++out.parts[(store.at(x, y, z) >> 2) - 1];
          }
      for (const mesh of voxels.meshes) {
        if (!mesh.visible) continue;
        const bytes = mesh.geometry.getAttribute("corner").array;
        for (let f = 0; f < mesh.geometry.drawRange.count / 6; ++f) {
          const edge = (a, b) => [0, 1, 2].reduce((sum, k) => sum + Math.abs(bytes[16 * f + 4 * a + k] - bytes[16 * f + 4 * b + k]), 0);
          out.drawn += edge(0, 1) * edge(1, 2);
        }
      }
      return out;
    }, step);
    assert.ok(faces > 1000, `step ${step} has ${faces} faces only`);
    assert.equal(drawn, faces, `area of what is drawn at step ${step}`);
    assert.equal(frontiers, found, `frontiers drawn at step ${step}`);
    const next = rows.find((row) => row.step === step + 1);
    if (next) assert.equal(frontiers, next.frontiers, `frontiers at the end of step ${step} and at the beginning of the next`);
    const bounding = await page.evaluate(() => window.frontlux.page.run.facts.bounding);
    rows.filter((row) => row.step === step).forEach((row, r) => near(parts[r] / bounding, row.robot_box, `part of ${row.robot} at step ${step}`));
  }
}

/** From above, a click on the highest voxel of a column reads that voxel. */
export async function picksAreRight(page) {
  // Later on the ceiling is known, and whatever lies below it is covered.
  await page.evaluate(() => window.frontlux.page.timeline.seek(1));
  await page.click("#view-top");
  for (const name of ["frontiers", "quality", "robots", "views", "travelled", "planned", "goals"]) await page.locator(`#layer-${name}`).uncheck();
  const tops = await page.evaluate(() => {
    const { scene } = window.frontlux.page, { store, run } = scene, size = run.facts.resolution, out = [];
    const view = scene.camera.position.clone(), { clientWidth: width, clientHeight: height } = scene.host;
    for (let x = store.low[0]; x <= store.high[0]; x += 5)
      for (let y = store.low[1]; y <= store.high[1]; y += 3)
        for (let z = store.high[2]; z >= store.low[2]; --z) {
          if ((store.at(x, y, z) & 3) === 2 && (store.at(x, y, z + 1) & 3) !== 1) break; // covered
          if ((store.at(x, y, z) & 3) !== 2) continue;
          const p = view.clone().set((x - 32767.5) * size, (y - 32767.5) * size, (z - 32767) * size).project(scene.camera);
          out.push({ key: [x, y, z], at: [((p.x + 1) / 2) * width, ((1 - p.y) / 2) * height] });
          break;
        }
    return out;
  });
  assert.ok(tops.length > 20);
  let hidden = 0;
  for (const { key, at } of tops) {
    const hit = await page.evaluate(([x, y]) => window.frontlux.page.pickAt(x, y), at);
    assert.equal(hit?.kind, "voxel");
    if (JSON.stringify(hit.key) !== JSON.stringify(key)) ++hidden; // the view is no straight one: others lean over it
    else assert.match(await page.textContent("#picked"), new RegExp(`Occupied voxel.*Key${key.join(", ")}First seen byu[ag]v`));
  }
  assert.ok(hidden < 0.2 * tops.length, `${hidden} of ${tops.length} clicks read another voxel`);
  const box = await page.locator("#view canvas").boundingBox();
  await page.mouse.click(box.x + tops[0].at[0], box.y + tops[0].at[1]);
  assert.equal(await page.isVisible("#picked"), true);
  await page.locator("#layer-planned").check();
  await page.evaluate(() => window.frontlux.page.timeline.seek(2));
  const kinds = await page.evaluate(() => {
    const { scene, run } = { ...window.frontlux.page, run: window.frontlux.page.run }, { clientWidth: width, clientHeight: height } = scene.host;
    const spot = (x, y, z) => {
      const p = scene.camera.position.clone().set(x, y, z).project(scene.camera);
      return window.frontlux.page.pickAt(((p.x + 1) / 2) * width, ((1 - p.y) / 2) * height)?.kind;
    };
    const path = run.paths[2 * run.robots + 1], image = run.images[2 * run.robots], size = run.facts.resolution;
    const cell = image.quality.indexOf(255), viewpoint = spot(...run.poses.subarray(path.begin + 4, path.begin + 7));
    document.getElementById("layer-quality").click();
    return [viewpoint, spot((image.x[cell] - 32767.5) * size, (image.y[cell] - 32767.5) * size, 0.04)];
  });
  assert.equal(kinds[0], "viewpoint");
  assert.ok(["cell", "viewpoint", "voxel"].includes(kinds[1]), `a place on the floor read as ${kinds[1]}`);
  for (const name of ["frontiers", "robots", "views", "travelled", "goals"]) await page.locator(`#layer-${name}`).check();
  await page.click("#view-home");
}
