// Makes dist/page.html, the page without runs, from src/: one file with script and style in it, and a policy
// that lets the browser run this script only and load nothing. `node build.mjs --check` says whether
// dist/page.html is what the sources make.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { readFile, writeFile, mkdir } from "node:fs/promises";
import { fileURLToPath } from "node:url";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));

async function bundle(entry, format) {
  const result = await build({
    entryPoints: [here(entry)], absWorkingDir: here("."), bundle: true, minify: true, write: false, format,
    target: ["es2022", "chrome109", "firefox115", "safari16.4"], charset: "ascii", legalComments: "none",
  });
  return result.outputFiles[0].text.trim();
}

async function notice(name) {
  const text = await readFile(here(`node_modules/${name}/LICENSE`), "utf8");
  return `${name}\n\n${text.trim()}\n`;
}

const hash = (text) => createHash("sha256").update(text, "utf8").digest("base64");

const notices = (await Promise.all(["three", "uplot"].map(notice))).join("\n");
const script = `/*! Contains parts of\n\n${notices}*/\n${await bundle("src/main.js", "iife")}\n`;
const style = `${await bundle("src/style.css")}\n`;
// These would end the element, or keep it from ending.
for (const [name, text, end] of [["script", script, /<\/script|<!--|<script/i], ["style", style, /<\/style|<!--/i]])
  if (end.test(text)) throw new Error(`the ${name} holds ${end.exec(text)[0]}, which HTML would read as markup`);
const parts = { "script-hash": hash(script), "style-hash": hash(style), style, script };
const page = (await readFile(here("src/page.html"), "utf8")).replace(/@@(script-hash|style-hash|style|script)@@/g, (_, name) => parts[name]);

if (process.argv.includes("--check")) {
  if ((await readFile(here("dist/page.html"), "utf8")) !== page) {
    console.error("dist/page.html is not what src/ makes: run ./dev report-page and commit it");
    process.exit(1);
  }
  console.log("dist/page.html is what src/ makes");
} else {
  await mkdir(here("dist"), { recursive: true });
  await writeFile(here("dist/page.html"), page);
  console.log(`dist/page.html: ${page.length} characters`);
}
