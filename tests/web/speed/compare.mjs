// Compares the time of an iteration in WebAssembly with the native one. `scripts/web --speed` runs it.
// Arguments: the native program, and the module for Node.js, whose engine is that of Chromium.

import { execFileSync } from "node:child_process";

const ROUNDS = 5;
const [native, module] = process.argv.slice(2);
const commands = [[native], [process.execPath, "-e", `require(${JSON.stringify(module)}); console.log(globalThis.speed)`]];

// Returns a row of numbers per size: unknowns, microseconds, displacement.
const run = ([program, ...args]) =>
  execFileSync(program, args, { encoding: "utf8" }).trim().split("\n").map((line) => line.split(" ").map(Number));
const median = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];

const rounds = [];
for (let round = 0; round < ROUNDS; round += 1) rounds.push(commands.map(run));
console.log(`µs an iteration of newton, T3, medians of ${ROUNDS} alternating runs\n`);
console.log("| unknowns | native, portable | WebAssembly with SIMD | ratio |\n|---|---|---|---|");
rounds[0][0].forEach(([unknowns, , tip], size) => {
  const other = rounds[0][1][size][2];
  if (!(Math.abs(other / tip - 1) <= 1e-9)) throw new Error(`${unknowns} unknowns: the tip is displaced by ${tip} and ${other}`);
  const [own, wasm] = [0, 1].map((which) => median(rounds.map((round) => round[which][size][1])));
  console.log(`| ${unknowns} | ${own.toFixed(1)} | ${wasm.toFixed(1)} | ${(wasm / own).toFixed(2)} |`);
});
