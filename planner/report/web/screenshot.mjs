// A picture of an open report, or of a part of it: screenshot.mjs REPORT.html PLACE PICTURE.png [SELECTOR]. PLACE is what the
// report's address has behind the #: t=20&camera=...
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [report, place, picture, part] = process.argv.slice(2);
const { chromium } = createRequire(import.meta.url)("playwright-core");
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
const page = await browser.newPage({ viewport: { width: 1280, height: 820 } });
await page.goto(`${pathToFileURL(resolve(report)).href}#${place}`);
await page.waitForFunction(() => window.frontlux.ready);
await page.waitForTimeout(500);  // until the camera rests
await (part ? page.locator(part) : page).screenshot({ path: picture });
await browser.close();
