// Every control of a report, used as a reader would, in both colour schemes, on a wide and on a narrow window.
import assert from "node:assert/strict";
import { both, open, shots } from "./open_report.mjs";

const STEP = 40; // of the first run: the robots are on their ways

/** What the page shows, as a word that is another one if anything looks different: texts, colours, view and charts. */
const shown = (page) => page.evaluate(async () => {
  const { page: { scene, second, besideRun } } = window.frontlux, parts = [];
  const digest = async (bytes) => [...new Uint8Array(await crypto.subtle.digest("SHA-256", bytes))].join();
  for (const one of [scene, besideRun && second].filter(Boolean)) {
    one.render();
    const gl = one.renderer.getContext(), pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    parts.push(await digest(pixels));
  }
  const open = [...document.querySelectorAll("details")].map((part) => part.open);
  parts.push(document.body.innerText, getComputedStyle(document.body).backgroundColor, open.join());
  return digest(new TextEncoder().encode(parts.join("\n")));
});

const read = (page, what) => page.evaluate((path) => path.split(".").reduce((value, name) => value[name], window.frontlux.page), what);

/** Buttons, by what they are called; each is clicked once. */
const BUTTONS = {
  theme: async (page, click) => {
    const before = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    await click();
    assert.notEqual(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), before);
    await click();
  },
  "view-home": (page, click) => moves(page, click, () => window.frontlux.page.scene.orbit(1, 0)),
  "view-top": (page, click) => moves(page, click, () => window.frontlux.page.scene.home()),
  "save-view": (page, click) => saves(page, click, /\.png$/),
  first: (page, click) => goesTo(page, click, () => 0),
  back: (page, click) => goesTo(page, click, (step) => step - 1),
  forward: (page, click) => goesTo(page, click, (step) => step + 1),
  last: (page, click) => goesTo(page, click, (_, steps) => steps - 1),
  play: async (page, click) => {
    const from = await read(page, "timeline.time");
    await click();
    await page.waitForFunction((time) => window.frontlux.page.timeline.time > time, from);
    await click();
    assert.equal(await read(page, "timeline.playing"), false);
  },
  SVG: (page, click) => saves(page, click, /\.svg$/),
  CSV: (page, click) => saves(page, click, /\.csv$/),
};

async function moves(page, click, before) {
  await page.evaluate(before);
  const seen = await shown(page);
  await click();
  assert.notEqual(await shown(page), seen, "the camera stays");
}

async function goesTo(page, click, where) {
  const [step, steps] = [await read(page, "timeline.step"), await read(page, "timeline.steps")];
  await click();
  assert.equal(await read(page, "timeline.step"), where(step, steps));
  await page.evaluate((s) => window.frontlux.page.timeline.seek(s), step);
}

async function saves(page, click, name) {
  const [download] = await Promise.all([page.waitForEvent("download"), click()]);
  assert.match(download.suggestedFilename(), name);
  await download.cancel();
}

/** Choices whose choosing is not seen at once: what they set instead. */
const QUIET = { speed: "timeline.speed" };
/** How many choices show what others show: in a run of 21 seconds the last 30 are the whole. */
const ALIKE = { trail: 1 };

async function selectWorks(page, control, id, begin) {
  const values = await control.locator("option").evaluateAll((options) => options.map((option) => option.value)), before = await control.inputValue();
  const state = () => (QUIET[id] ? read(page, QUIET[id]) : shown(page)), seen = new Set([QUIET[id] ? await state() : begin]);
  for (const value of values.filter((one) => one !== before)) {
    await control.selectOption(value);
    seen.add(await state());
  }
  assert.equal(seen.size, values.length - (ALIKE[id] ?? 0), `choices of ${id} that show something of their own`);
  await control.selectOption(before);
}

async function switchWorks(page, control, id, begin) {
  const checked = await control.isChecked();
  await control.setChecked(!checked);
  assert.notEqual(await shown(page), begin, `${id} changes nothing`);
  await control.setChecked(checked);
}

async function sliderWorks(page, control, id, begin) {
  const value = await control.inputValue();
  await control.fill("3");
  assert.notEqual(await shown(page), begin, `${id} changes nothing`);
  await control.fill(value);
}

export async function controlsWork(browser) {
  for (const colorScheme of ["light", "dark"])
    for (const [width, height] of [[1440, 900], [390, 844]]) {
      const { page, trouble } = await open(browser, both, { colorScheme, viewport: { width, height } });
      const restart = () => page.evaluate((step) => {
        window.frontlux.page.timeline.seek(step); // choosing a run goes to its end
        window.frontlux.page.scene.home();
      }, STEP);
      await restart();
      const begin = await shown(page);
      const controls = page.locator("button, input, select, summary"), count = await controls.count(), used = {};
      for (let i = 0; i < count; ++i) {
        const control = controls.nth(i);
        const [tag, type, id] = await control.evaluate((one) => [one.tagName, one.type, one.id || one.textContent]);
        if (!(await control.isVisible())) assert.fail(`${id} cannot be seen on ${width} px`);
        used[tag] = (used[tag] ?? 0) + 1;
        await restart();
        if (tag === "BUTTON") await (BUTTONS[id] ?? assert.fail)(page, () => control.click());
        else if (tag === "SELECT") await selectWorks(page, control, id, begin);
        else if (tag === "INPUT") await (type === "checkbox" ? switchWorks : sliderWorks)(page, control, id, begin);
        else await foldWorks(page, control);
      }
      assert.ok(used.BUTTON > 15 && used.INPUT >= 14 && used.SELECT >= 8 && used.SUMMARY === 3, JSON.stringify(used));
      await restart();
      assert.equal(await shown(page), begin, "some control is not back where it was");
      await page.evaluate(() => scrollTo(0, 0));
      await page.screenshot({ path: `${shots}/controls_${width}_${colorScheme}.png` });
      assert.deepEqual(trouble, []);
      await page.close();
    }
}

async function foldWorks(page, control) {
  const length = () => page.evaluate(() => document.body.innerText.length), before = await length();
  await control.click();
  await page.waitForFunction((shorter) => document.body.innerText.length > shorter, before);
  await control.click();
}
