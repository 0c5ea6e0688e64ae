// What can be taken along from a report: values at the pointer, saved files, addresses, prints.
import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import { near } from "./number_checks.mjs";
import { both, explored, open, shots } from "./open_report.mjs";

/** The values at the pointer are in the legends of all charts at once. */
export async function pointerIsRight(page, rows) {
  const first = rows.filter((row) => row.robot === rows[0].robot), last = first.length - 1;
  await page.evaluate(() => window.frontlux.page.timeline.seek(0));
  const legend = (id) => page.locator(`#chart-${id} .legend .value`).allTextContents(), before = await legend("frontiers");
  const box = await page.locator("#chart-volume .u-over").boundingBox();
  await page.mouse.move(box.x + box.width - 2, box.y + box.height / 2);
  assert.deepEqual((await legend("frontiers")).map((text) => Number(text.replaceAll(",", "")))[0], first[last].frontiers);
  assert.equal((await legend("coverage"))[0], await page.evaluate((value) => window.frontlux.percent(value), first[last].coverage_observable));
  assert.equal(await page.isVisible("#chart-gain .pointed"), true);
  await page.mouse.move(2, 2);
  assert.deepEqual(await legend("frontiers"), before, "the time line's values are not back");
  assert.equal(await page.isVisible("#chart-gain .pointed"), false);
}

/** What is saved holds what is shown. */
export async function savedFilesAreRight(page, rows) {
  const saved = async (act) => {
    const [download] = await Promise.all([page.waitForEvent("download"), act()]);
    return { name: download.suggestedFilename(), bytes: await readFile(await download.path()) };
  };
  const button = (id, kind) => () => page.locator(`#chart-${id} .save button`, { hasText: kind }).click();
  const first = rows.filter((row) => row.robot === rows[0].robot), robots = [...new Set(rows.map((row) => row.robot))];
  const table = await saved(button("coverage", "CSV"));
  assert.match(table.name, /_coverage_time\.csv$/);
  const lines = table.bytes.toString().trim().split("\n").map((line) => line.split(","));
  assert.equal(table.bytes.toString().split("\n")[0], `"time, s",team,${robots.join(",")}`);
  assert.equal(lines.length, 1 + first.length);
  first.forEach((row, s) => {
    near(Number(lines[1 + s][0]), row.time_s, "time in the table");
    near(Number(lines[1 + s][1]), row.coverage_observable, "coverage in the table");
  });
  for (const id of ["coverage", "planning"]) {
    const picture = await saved(button(id, "SVG"));
    const curves = await page.evaluate((text) => {
      const svg = new DOMParser().parseFromString(text, "image/svg+xml");
      return svg.querySelector("parsererror") ? -1 : svg.querySelectorAll(".curve").length;
    }, picture.bytes.toString());
    assert.equal(curves, await page.locator(`#chart-${id} .legend li`).count(), `curves in the picture of ${id}`);
    await writeFile(`${shots}/chart_${id}.svg`, picture.bytes);
  }
  const view = await saved(() => page.click("#save-view"));
  assert.match(view.name, /^[\w.+-]+\.png$/);
  assert.equal(view.bytes.subarray(1, 4).toString(), "PNG");
  const size = await page.evaluate(() => [window.frontlux.page.scene.canvas.width, window.frontlux.page.scene.canvas.height]);
  assert.equal(view.bytes.readUInt32BE(16), size[0]);
  assert.ok(view.bytes.readUInt32BE(20) > size[1] && view.bytes.length > 5000, `${view.bytes.length} bytes`);
  await writeFile(`${shots}/view.png`, view.bytes);
}

/** The address names the moment and the camera, and a report that is opened with it shows them. */
export async function addressIsRight(browser) {
  const { page, trouble } = await open(browser, explored);
  assert.equal(await page.evaluate(() => location.hash), "", "nothing was moved");
  await page.evaluate(() => {
    window.frontlux.page.timeline.seek(7);
    window.frontlux.page.scene.orbit(0.7, 0.2);
  });
  await page.waitForFunction(() => location.hash !== "");
  const [hash, time, place] = await page.evaluate(() => [location.hash, window.frontlux.page.timeline.time, window.frontlux.page.scene.place]);
  assert.match(hash, /^#t=[\d.]+&step=7&camera=[-\d.,]+$/);
  const shown = (where) => where.evaluate(() => [window.frontlux.page.timeline.time, window.frontlux.page.scene.place, window.frontlux.page.shown]);
  const other = await open(browser, explored, {}, hash);
  const [theirTime, theirPlace] = await shown(other.page);
  assert.deepEqual([theirTime, await other.page.evaluate(() => window.frontlux.page.timeline.step)], [time, 7]);
  theirPlace.forEach((value, i) => assert.ok(Math.abs(value - place[i]) < 0.01, `camera ${theirPlace} instead of ${place}`));
  await other.page.evaluate(() => (location.hash = "#t=3"));
  await other.page.waitForFunction(() => Math.abs(window.frontlux.page.timeline.time - 3) < 1e-9);
  for (const wild of ["#t=x&camera=1,2", "#t=&run=9", "#camera=1,2,3,4,5,Infinity", "#%zz", "#t=1e9"]) {
    const odd = await open(browser, both, {}, wild);
    const [t] = await shown(odd.page);
    assert.ok(Number.isFinite(t));
    assert.deepEqual(odd.trouble, [], wild);
    await odd.page.close();
  }
  const second = await open(browser, both, {}, "#run=1&t=20");
  assert.deepEqual((await shown(second.page)).filter((_, i) => i !== 1), [20, 1]);
  assert.equal(await second.page.inputValue("#run"), "1");
  assert.deepEqual([...trouble, ...other.trouble, ...second.trouble], []);
  for (const opened of [page, other.page, second.page]) await opened.close();
}

/** On paper nothing is cropped, and the views are there in light colours. */
export async function printsWhole(browser) {
  for (const folder of [explored, both]) {
    const { page, trouble } = await open(browser, folder, { colorScheme: "dark", viewport: { width: 718, height: 1000 } });
    await page.emulateMedia({ media: "print", colorScheme: "dark" });
    await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
    await page.waitForFunction(() => document.querySelector(".print-view").complete);
    const found = await page.evaluate(() => ({
      wide: [...document.querySelectorAll("body *")].filter((one) => one.getClientRects().length > 0 && one.getBoundingClientRect().right > innerWidth + 1).map((one) => `${one.tagName}.${one.className}`),
      cropped: [...document.querySelectorAll(".table-scroll")].filter((one) => one.scrollWidth > one.clientWidth + 1 || one.scrollHeight > one.clientHeight + 1).length,
      paper: getComputedStyle(document.body).backgroundColor, swatches: getComputedStyle(document.querySelector(".swatch")).printColorAdjust,
      picture: document.querySelector(".print-view").naturalWidth,
    }));
    assert.deepEqual(found.wide, [], "wider than the page");
    assert.equal(found.cropped, 0);
    assert.deepEqual([found.paper, found.swatches], ["rgb(255, 255, 255)", "exact"]);
    assert.ok(found.picture > 100);
    await page.screenshot({ path: `${shots}/print_${folder === both ? "both" : "one"}.png`, fullPage: true });
    await page.evaluate(() => dispatchEvent(new Event("afterprint")));
    assert.equal(await page.locator(".print-view").count(), 0);
    assert.ok((await page.pdf({ format: "A4" })).length > 20000);
    assert.deepEqual(trouble, []);
    await page.close();
  }
}
