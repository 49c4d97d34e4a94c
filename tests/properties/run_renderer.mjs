// Runs the page's renderer over the cases on standard input; for test_interpreters.py.
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const { Renderer } = await import(pathToFileURL(process.argv[2]));
// JSON has no numbers that are not finite; they come and go as texts.
const number = (one) => (typeof one === "string" ? Number(one) : one);
const text = (one) => (Number.isFinite(one) ? one : String(one));
const cases = JSON.parse(readFileSync(0, "utf8"));
const answers = cases.map(({ program, samples }) => {
  const renderer = new Renderer(program);
  const amplitude = [], flags = [], value = [];
  for (const sample of samples) {
    const [x, y, v, t] = sample.map(number);
    amplitude.push(text(renderer.tick(x, y, v, t)));
    flags.push(renderer.flags);
  }
  const counters = renderer.counters;
  for (const sample of samples) value.push(text(renderer.value(...sample.map(number))));
  return { amplitude, flags, value, counters };
});
process.stdout.write(JSON.stringify(answers));
