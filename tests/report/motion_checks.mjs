// What a report shows of robots in motion, compared with the tables of the run.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { near, readTable } from "./number_checks.mjs";
import { explored, lockstep, lookOf, open, shots } from "./open_report.mjs";
import { pointerIsRight, savedFilesAreRight } from "./taking_checks.mjs";

/** The planned tours at each step are those of tours.csv, and are drawn from where the robot is. */
export async function toursAreRight(browser) {
  const { page, trouble } = await open(browser, explored), rows = await readTable(`${explored}/tours.csv`), steps = await readTable(`${explored}/steps.csv`);
  const robots = [...new Set(steps.map((row) => row.robot))], last = steps.at(-1).step;
  const planned = (step, robot) => {
    if (steps.find((row) => row.step === step && row.robot === robot).goal_x_m === "") return [];
    const made = rows.findLast((row) => row.step <= step && row.robot === robot)?.step;
    return rows.filter((row) => row.step === made && row.robot === robot);
  };
  const seen = await page.evaluate(() => {
    const { run } = window.frontlux.page;
    return run.tours.map((tour) => tour && { poses: Array.from(run.poses.subarray(tour.begin, tour.begin + 4 * tour.count)), clusters: tour.clusters, frontiers: tour.frontiers });
  });
  let longest = 0, best = 0;
  for (let step = 0; step <= last; ++step)
    robots.forEach((robot, r) => {
      const want = planned(step, robot), tour = seen[step * robots.length + r];
      assert.equal(tour?.clusters.length ?? 0, want.length, `stops of ${robot} at step ${step}`);
      if (want.length === 0) return;
      assert.deepEqual([tour.clusters, tour.frontiers], ["clusters", "frontiers"].map((name) => want.map((row) => row[name])));
      want.flatMap((row) => [row.x_m, row.y_m, row.z_m, row.yaw_rad]).forEach((value, i) => assert.ok(Math.abs(tour.poses[i] - value) < 1e-5));
      if (want.length > longest) [longest, best] = [want.length, step];
    });
  assert.ok(longest > 1, "the run has no tour of several stops");
  const shown = await page.evaluate((step) => {
    const { timeline, scene } = window.frontlux.page;
    timeline.seek(step);
    return scene.tours.map(({ group, marks, line, r }) => ({ visible: group.visible, marks: marks.filter((mark) => mark.visible).map((mark) => mark.position.toArray()), stops: line.geometry.instanceCount,
      begin: Array.from(line.geometry.attributes.instanceStart.data.array.subarray(0, 3)), robot: Array.from(scene.robots[r].pose.subarray(0, 3)) }));
  }, best);
  robots.forEach((robot, r) => {
    const want = planned(best, robot), { visible, marks, stops, begin, robot: where } = shown[r];
    assert.equal(visible, want.length > 0);
    if (!visible) return;
    assert.deepEqual([marks.length, stops], [want.length, want.length]);
    begin.forEach((value, k) => near(value, Math.fround(where[k]), "where the line begins"));
  });
  const look = () => lookOf(page);
  await page.screenshot({ path: `${shots}/tours.png` });
  await trailsWork(page);
  await page.evaluate((step) => window.frontlux.page.timeline.seek(step), best);
  await pointerIsRight(page, steps);
  await savedFilesAreRight(page, steps);
  await page.evaluate((step) => window.frontlux.page.timeline.seek(step), best);
  const before = await look();
  await page.keyboard.press("9");
  assert.equal(await page.isChecked("#layer-tours"), false);
  assert.notEqual(await look(), before, "tours off looks the same");
  await page.keyboard.press("9");
  assert.equal(await look(), before);
  // A click on a stop tells which one it is.
  for (const name of ["voxels", "frontiers", "planned"]) await page.locator(`#layer-${name}`).uncheck();
  const r = robots.findIndex((robot) => planned(best, robot).length === longest);
  const said = await page.evaluate((tour) => {
    const { page: report } = window.frontlux, { scene } = report, { clientWidth: width, clientHeight: height } = scene.host;
    const p = scene.tours[tour].marks[1].position.clone().project(scene.camera);
    return report.pickAt(((p.x + 1) / 2) * width, ((1 - p.y) / 2) * height);
  }, r);
  assert.equal(said.kind, "stop");
  assert.match(await page.textContent("#picked"), new RegExp(`Stop of the tour[12] of ${longest}, ${robots[r]}To look at\\d+ frontiers in \\d+ cluster`));
  assert.match(await page.textContent(".key"), /planned tour/);
  assert.deepEqual(trouble, []);
  await page.close();
}

/** Only the last part of the travelled paths stands out, if that is wanted. */
export async function trailsWork(page) {
  await page.evaluate(() => window.frontlux.page.timeline.seek(30));
  const counts = () => page.evaluate(() => window.frontlux.page.scene.robots.map(({ trail, recent, materials }) => [trail.geometry.instanceCount, recent.geometry.instanceCount, materials.trail.opacity]));
  const whole = await counts();
  assert.ok(whole.every(([all, recent, opacity]) => all > 0 && recent === 0 && opacity === 1));
  const { run, time } = await page.evaluate(() => ({ run: { steps: window.frontlux.page.run.steps }, time: Array.from(window.frontlux.page.run.numbers.time) }));
  assert.ok(run.steps > 30 && time[30] > 3);
  await page.evaluate(() => window.frontlux.page.scene.setTrail(3));
  const recent = await counts(), after = time.findIndex((end) => end > time[30] - 3);
  const ends = await page.evaluate((s) => window.frontlux.page.scene.robots.map((robot) => robot.trailEnd[s - 1]), after);
  recent.forEach(([all, last], r) => assert.deepEqual([all, last], [whole[r][0], whole[r][0] - ends[r]]));
  await page.selectOption("#trail", "10");
  await page.selectOption("#trail", "Infinity");
  assert.deepEqual(await counts(), whole);
}

/** The distance [m] of a place to a line through points x, y, z. */
function distanceTo(points, [x, y, z]) {
  let best = Infinity;
  for (let i = 0; i + 3 < points.length; i += 3) {
    const a = points.slice(i, i + 3), along = a.map((k, axis) => points[i + 3 + axis] - k), to = [x - a[0], y - a[1], z - a[2]];
    const dot = (u, v) => u.reduce((sum, k, axis) => sum + k * v[axis], 0), length = dot(along, along);
    const part = length > 0 ? Math.min(1, Math.max(0, dot(to, along) / length)) : 0;
    best = Math.min(best, Math.hypot(...to.map((k, axis) => k - part * along[axis])));
  }
  return best;
}

/** Trajectories are as long as events.csv says, and robots go along them, as motion.csv has it, until they plan again. */
export async function trajectoriesAreRight(browser) {
  const { page, trouble } = await open(browser, explored);
  const [events, motion] = [await readTable(`${explored}/events.csv`), await readTable(`${explored}/motion.csv`)];
  const robots = [...new Set(motion.map((row) => row.robot))], latency = JSON.parse(await readFile(`${explored}/run.json`, "utf8")).latency_s;
  const planned = await page.evaluate(() => window.frontlux.page.run.trajectories.map((points) => points && Array.from(points)));
  let compared = 0, longest = 0, best = 0;
  events.forEach((event, i) => {
    const points = planned[event.step * robots.length + robots.indexOf(event.robot)];
    if (!points) return assert.ok(event.length_m < 0.01, `no trajectory of ${event.length_m} m at step ${event.step}`);
    let length = 0;
    for (let k = 3; k < points.length; k += 3) length += Math.hypot(...[0, 1, 2].map((axis) => points[k + axis] - points[k + axis - 3]));
    // Of a trajectory that the robot has kept the rest is shown.
    const kept = events.slice(0, i).some((before) => before.robot === event.robot && before.begin_s === event.begin_s), begin = kept ? event.time_s + latency : event.begin_s;
    const far = Math.abs(length - event.length_m) >= 0.02 + 0.03 * event.length_m;
    assert.ok(kept ? length < event.length_m + 0.02 : !far, `${length} m at step ${event.step} instead of ${event.length_m} m`);
    if (length > longest) [longest, best] = [length, event.step];
    const next = events.slice(i + 1).find(({ robot }) => robot === event.robot)?.begin_s ?? event.end_s;
    for (const row of motion.filter(({ robot, time_s: time }) => robot === event.robot && time >= begin && time <= next)) {
      assert.ok(distanceTo(points, [row.x_m, row.y_m, row.z_m]) < 0.1, `${row.robot} is off its trajectory at ${row.time_s} s`);
      ++compared;
    }
  });
  assert.ok(compared > 500 && longest > 1, `${compared} places, ${longest} m`);
  // The last one that a robot has planned is drawn, and key 0 is for it.
  const drawn = await page.evaluate((step) => {
    const { scene, timeline } = window.frontlux.page;
    timeline.seek(step);
    return scene.trajectories.map(({ line }) => ({ visible: line.visible, begin: Array.from(line.geometry.attributes.instanceStart.data.array.subarray(0, 6)), segments: line.geometry.instanceCount }));
  }, best);
  robots.forEach((robot, r) => {
    const step = events.findLast((event) => event.robot === robot && event.step <= best && planned[event.step * robots.length + r]).step;
    const points = planned[step * robots.length + r];
    assert.deepEqual(drawn[r], { visible: true, begin: points.slice(0, 6), segments: points.length / 3 - 1 });
  });
  const before = await lookOf(page);
  await page.keyboard.press("0");
  assert.equal(await page.isChecked("#layer-trajectories"), false);
  assert.notEqual(await lookOf(page), before, "trajectories off looks the same");
  await page.keyboard.press("0");
  assert.equal(await lookOf(page), before);
  assert.deepEqual(trouble, []);
  await page.close();
}

/** As many frontiers are a robot's as steps.csv says, and they are drawn in its colour. */
export async function frontiersAreTheirs(browser) {
  for (const colorScheme of ["light", "dark"]) {
    const { page, trouble } = await open(browser, explored, { colorScheme });
    const [events, rows] = [await readTable(`${explored}/events.csv`), await readTable(`${explored}/steps.csv`)];
    const robots = [...new Set(rows.map((row) => row.robot))];
    let several = 0;
    for (const event of events.filter(({ reason, goal_state: state }) => reason !== "period" && state === "assigned")) {
      const { own, drawn, expected, tints, colors } = await page.evaluate(([step, r]) => {
        const { scene: { store, voxels }, timeline, run: { facts } } = window.frontlux.page, sides = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
        timeline.seek(step);
        const count = () => Array(1 + facts.robots.length).fill(0), out = { own: 0, drawn: count(), expected: count() };
        for (const mask of store.assignment.masks.values()) out.own += (mask >> r) & 1;
        for (const cloud of voxels.clouds.filter((one) => one.visible)) {
          const bytes = cloud.geometry.getAttribute("corner").array;
          for (let i = 0; i < cloud.geometry.drawRange.count; ++i) ++out.drawn[bytes[4 * i + 3]];
        }
        const [low, high] = facts.bounds;
        for (let x = low[0]; x <= high[0]; ++x)
          for (let y = low[1]; y <= high[1]; ++y)
            for (let z = low[2]; z <= high[2]; ++z)
              if ((store.at(x, y, z) & 3) === 0 && sides.some(([a, b, c]) => (store.at(x + a, y + b, z + c) & 3) === 1)) ++out.expected[store.assignment.ownerOf(x, y, z)];
        const hex = (tint) => `#${tint.toArray().map((k) => Math.round(255 * k).toString(16).padStart(2, "0")).join("")}`;
        return { ...out, tints: voxels.pointsMaterial.uniforms.tints.value.slice(1, 1 + facts.robots.length).map(hex), colors: facts.robots.map((robot) => robot.colors) };
      }, [event.step, robots.indexOf(event.robot)]);
      assert.equal(own, rows.find(({ step, robot }) => step === event.step && robot === event.robot).assigned, `frontiers of ${event.robot} at step ${event.step}`);
      assert.deepEqual(drawn, expected, `frontiers by robot at step ${event.step}`);
      assert.deepEqual(tints, colors.map((pair) => pair[colorScheme === "dark" ? 1 : 0].toLowerCase()));
      several += drawn.slice(1).every((part) => part > 0) ? 1 : 0;
    }
    assert.ok(several > 0, "there is no step in which all robots have frontiers");
    assert.match(await page.textContent(".key"), /frontier of nobody or several.*of ugv/);
    assert.deepEqual(trouble, []);
    await page.close();
  }
}

/** Each robot's goal is one of its candidates, and a click on one tells whose it is and what it is worth. */
export async function candidatesAreRight(browser) {
  for (const folder of [explored, lockstep]) {
    const { page, trouble } = await open(browser, folder);
    const { goals, found, most } = await page.evaluate(() => {
      const { run } = window.frontlux.page, count = run.robots, out = { goals: Array(count).fill(0), found: Array(count).fill(0), most: Array(count).fill(0) };
      run.images.forEach((image, i) => {
        const r = i % count, goal = run.facts.steps[Math.floor(i / count)].robots[r].goal;
        if (!image) return;
        out.most[r] = Math.max(out.most[r], image.count);
        if (!goal) return;
        const key = goal.slice(0, 3).map((k) => Math.floor(k / run.facts.resolution) + 32768);
        ++out.goals[r];
        for (let c = 0; c < image.count; ++c)
          if (image.x[c] === key[0] && image.y[c] === key[1] && image.z[c] === key[2]) return ++out.found[r];
      });
      return out;
    });
    assert.deepEqual(found, goals, "goals that are candidates");
    assert.ok(goals.every((number) => number > 2) && most.every((number) => number > 5), `${goals} goals, ${most} candidates`);
    const hit = await page.evaluate(() => {
      const { page: report } = window.frontlux, { scene, timeline, run } = report, { clientWidth: width, clientHeight: height } = scene.host;
      const anywhere = scene.images.find((image) => image.pick && image.placeOf), r = anywhere.robot;
      timeline.seek(run.images.findIndex((image, i) => image && i % run.robots === r) / run.robots | 0);
      for (const name of ["voxels", "frontiers", "planned", "tours"]) document.getElementById(`layer-${name}`)?.click();
      const image = anywhere.shownImage, best = image.quality.indexOf(255);
      const p = scene.camera.position.clone().set(...anywhere.placeOf(image, best)).project(scene.camera);
      return { visible: anywhere.mesh.visible, kind: report.pickAt(((p.x + 1) / 2) * width, ((1 - p.y) / 2) * height)?.kind, name: run.facts.robots[r].name };
    });
    assert.deepEqual([hit.visible, hit.kind], [true, "cell"]);
    assert.match(await page.textContent("#picked"), new RegExp(`Candidate-?[\\d.]+, -?[\\d.]+, -?[\\d.]+ m, (${hit.name}|ugv)View quality[\\d.]+Expected gain\\d+ frontiers`));
    const before = await lookOf(page);
    await page.locator("#layer-quality").uncheck();
    assert.notEqual(await lookOf(page), before, "view quality off looks the same");
    assert.deepEqual(trouble, []);
    await page.close();
  }
}
