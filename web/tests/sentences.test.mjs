/** What the server says in English is said in German: sentences of some hundred worlds, one of each kind. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import { before, test } from "node:test";
import { build } from "vite";

const source = path.resolve(import.meta.dirname, "../src/lib/sentences.ts");
const read = (file) => JSON.parse(readFileSync(file, "utf8"));
const words = read(path.resolve(import.meta.dirname, "../src/texts/names/de.json"));
const speaker = {
  figure: (value) => String(value).replace(".", ","),
  named: (name) => words.objects[name.toLowerCase().replaceAll(" ", "_")] ?? name,
  quoted: (said) => `„${said}“`,
  listed: (all, more) => [...all, ...(more > 0 ? [`${more} weitere`] : [])].join(", "),
};
let german;

before(async () => {
  const made = await build({ configFile: false, logLevel: "error", build: { write: false, lib: { entry: source, formats: ["es"], fileName: "sentences" } } });
  const { compiled, inWords } = await import(`data:text/javascript;base64,${Buffer.from([made].flat()[0].output[0].code).toString("base64")}`);
  const patterns = compiled(read(path.resolve(import.meta.dirname, "../src/texts/sentences/de.json")));
  german = (text) => inWords(text, patterns, speaker);
});

test("figures, things, quotations and places are put where they belong", () => {
  assert.equal(german("4 asked for, 2 built"), "4 gewünscht, 2 gebaut");
  assert.equal(german("no such room was built on level 1 above the ground; `nook` was not understood"), "kein solcher Raum wurde im 1. Obergeschoss gebaut; nicht verstanden: „nook“");
  assert.equal(german("none in Workshop 2; no room was found for the object bookshelf; it was left out"), `keines in: Workshop 2; kein Raum hatte Platz dafür, es fehlt: ${words.objects.bookshelf}`);
  assert.equal(german("not separate: Bay 1, Bay 2 and 3 more"), "nicht getrennt: Bay 1, Bay 2, 3 weitere");
  assert.equal(german("not understood, and so not planned: `a; b`, `c`"), "nicht verstanden und deshalb nicht geplant: „a; b“, „c“");
  assert.equal(german("something that nobody has said before"), undefined);
});

test("what worlds have said is said", () => {
  const said = readFileSync(path.resolve(import.meta.dirname, "sentences.txt"), "utf8").trim().split("\n");
  assert.deepEqual(said.filter((text) => german(text) === undefined), []);
});
