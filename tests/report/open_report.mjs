// Opens reports in headless Chromium.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

/** What browser_test.sh has made, and where screenshots go: see browser_test.mjs. */
export const [web, executablePath, shots, reports, evil, explored, lockstep, both, long] = process.argv.slice(2).map((path) => resolve(path));
const { chromium } = createRequire(`${web}/package.json`)("playwright-core");
const kWithGraphics = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const kWithout = ["--no-sandbox", "--disable-gpu", "--disable-3d-apis"];

/** Does something with a browser that has WebGL, or has none. */
export async function inBrowser(graphics, act) {
  const browser = await chromium.launch({ executablePath, args: graphics ? kWithGraphics : kWithout });
  try {
    await act(browser);
  } finally {
    await browser.close();
  }
}

/** Opens a report; whatever it asks of the network or complains about is an error. */
export async function open(browser, folder, options = {}, hash = "") {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, ...options });
  const trouble = [], file = pathToFileURL(`${folder}/report.html`).href;
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && !/GPU stall|GL Driver/.test(message.text()) && trouble.push(message.text()));
  page.on("pageerror", (error) => trouble.push(error.stack));
  page.on("dialog", (dialog) => trouble.push(`dialog: ${dialog.message()}`));
  await page.route("**", (route) => {
    if (route.request().url().split("#")[0] === file) return route.continue();
    trouble.push(`request: ${route.request().url()}`);
    return route.abort();
  });
  const began = Date.now();
  await page.goto(file + hash);
  await page.waitForFunction(() => window.frontlux.ready || window.frontlux.error);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  assert.equal(await page.evaluate(() => window.frontlux.error), undefined);
  return { page, trouble, seconds: (Date.now() - began) / 1000 };
}

/** What the view shows, as a word that is another one if anything looks different. */
export async function lookOf(page) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  return createHash("sha256").update(await page.locator("#view canvas").screenshot()).digest("hex");
}
