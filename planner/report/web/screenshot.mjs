// A picture of an open report: screenshot.mjs REPORT.html SECONDS PICTURE.png, at a moment on the run's clock.
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [report, seconds, picture] = process.argv.slice(2);
const { chromium } = createRequire(import.meta.url)("playwright-core");
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
const page = await browser.newPage({ viewport: { width: 1280, height: 740 } });
await page.goto(`${pathToFileURL(resolve(report)).href}#t=${seconds}`);
await page.waitForFunction(() => window.frontlux.ready);
await page.waitForTimeout(500);  // until the camera rests
await page.screenshot({ path: picture });
await browser.close();
