// Tests of the web page in a headless Chromium, through WebGL 2 and through WebGPU. scripts/test-web runs them.
// Arguments: the folder of the page, the program warpbeam, a folder for pictures, and optionally a part of the names of the tests.

import { execFileSync } from "node:child_process";
import { createReadStream, existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { extname, join, normalize } from "node:path";
import { deflateRawSync, gzipSync } from "node:zlib";

const { chromium } = createRequire(join(process.env.WEB_MODULES ?? process.cwd(), "package.json"))("playwright-core");
const [dist, warpbeam, pictures, part = ""] = process.argv.slice(2);
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";
// Position of the button that measures, points from the lower left corner of the view: under the line of the status and the tabs.
const MEASURE = [60, 34 + 49];
// Position of the field of the force in a window of this size.
const FORCE = [1219, 170];
const SIZE = { width: 1280, height: 800 };
// Software rendering on a loaded machine is slow; no test passes or fails by its time below this limit.
const PATIENCE = Number(process.env.WEB_PATIENCE ?? 180) * 1000;
const COMMON = ["--no-sandbox", "--ignore-gpu-blocklist", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const BACKENDS = {
  "WebGL 2": [...COMMON, "--disable-features=WebGPU"],
  WebGPU: [...COMMON, "--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-features=Vulkan,WebGPU", "--use-vulkan=swiftshader"],
};

const TYPES = { ".html": "text/html", ".js": "text/javascript", ".wasm": "application/wasm" };
const server = createServer((request, response) => {
  const path = join(dist, normalize(new URL(request.url, "http://host").pathname).replace(/\/$/, "/index.html"));
  if (!existsSync(path)) return response.writeHead(404).end();
  response.writeHead(200, { "content-type": TYPES[extname(path)] ?? "application/octet-stream" });
  createReadStream(path).pipe(response);
});
await new Promise((done) => server.listen(0, "127.0.0.1", done));
const address = `http://127.0.0.1:${server.address().port}/`;

const native = (...args) => JSON.parse(execFileSync(warpbeam, args, { encoding: "utf8" }));

function equal(actual, expected, message) {
  if (actual !== expected) throw new Error(`${message}: expected ${expected}, got ${actual}`);
}

function near(actual, expected, tolerance, message) {
  const scale = Math.max(Math.abs(expected), 1e-12);
  if (!(Math.abs(actual - expected) <= tolerance * scale)) throw new Error(`${message}: expected ${expected}, got ${actual}`);
}

// Compares the displacements of all probes.
function nearProbes(actual, expected, tolerance) {
  expected.forEach((probe, i) => [0, 1].forEach((k) => near(actual[i].u[k], probe.u[k], tolerance, `${probe.name}, component ${k}`)));
}

// Opens the page, and calls `test` with helpers; console errors fail it.
async function onPage(browser, query, test, options = {}) {
  const context = await browser.newContext({ viewport: SIZE, permissions: ["clipboard-read", "clipboard-write"], ...options });
  const page = await context.newPage();
  const errors = [];
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  page.on("pageerror", (error) => errors.push(String(error)));
  try {
    await page.goto(address + query);
    await page.waitForFunction(() => document.body.className === "ready" || document.getElementById("message").role === "alert", null, { timeout: PATIENCE });
    equal(await page.getAttribute("body", "class"), "ready", await page.textContent("#message"));
    const report = async () => JSON.parse(await page.evaluate(() => warpbeam.report()));
    const until = async (condition, text) => {
      const end = Date.now() + PATIENCE;
      for (;;) {
        const now = await report();
        if (condition(now)) return now;
        if (Date.now() > end) throw new Error(`${text} in vain: ${JSON.stringify(now)}`);
        await page.waitForTimeout(50);
      }
    };
    // Waits until the body and the camera are at rest, and an arrow is shown.
    const still = async () => {
      for (let last = {}; ; await page.waitForTimeout(500)) {
        const now = await until((now) => settled(now) && now.arrow_tips.length > 0, "waited for convergence");
        if (now.scale === last.scale && JSON.stringify(now.arrow_tips) === JSON.stringify(last.arrow_tips)) return now;
        last = now;
      }
    };
    await test({ page, context, report, until, still, open: (query) => page.goto(address + query) });
    equal(errors.join("\n"), "", "console errors");
  } finally {
    await context.close();
  }
}

// Share of the pixels of two PNG files that differ by more than 48 of 255 in a channel.
async function difference(browser, [one, other]) {
  const page = await browser.newPage();
  const data = [one, other].map((path) => `data:image/png;base64,${readFileSync(path).toString("base64")}`);
  const share = await page.evaluate(async (data) => {
    const pixels = async (url) => {
      const image = new Image();
      image.src = url;
      await image.decode();
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = canvas.getContext("2d");
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height).data;
    };
    const [a, b] = [await pixels(data[0]), await pixels(data[1])];
    if (a.length !== b.length) return 1;
    let different = 0;
    for (let i = 0; i < a.length; i += 4) {
      different += [0, 1, 2].some((channel) => Math.abs(a[i + channel] - b[i + channel]) > 48);
    }
    return different / (a.length / 4);
  }, data);
  await page.close();
  return share;
}

// Records the longest time that the page stands still.
function watchPauses() {
  let last = performance.now();
  globalThis.longest = 0;
  setInterval(() => {
    const now = performance.now();
    globalThis.longest = Math.max(globalThis.longest, now - last);
    last = now;
  }, 5);
}

const settled = (now) => now.status === "converged" && !now.is_computing;

const TESTS = {
  async "the article's beam converges to the native numbers"(browser) {
    const expected = native("solve", "article", "--json");
    await onPage(browser, "?scene=article&lang=en", async ({ until }) => {
      const now = await until(settled, "waited for convergence");
      equal(now.unknowns, expected.dofs, "unknowns");
      nearProbes(now.probes, expected.probes, 1e-9);
    });
  },

  async "a drag of the arrow changes the force, and an undo restores it, on a Mac with Cmd"(browser) {
    const drag = (undo) => async ({ page, until, still }) => {
      // Any input ends the animation of the start.
      await page.mouse.move(640, 700);
      const before = await still();
      const [tip] = before.arrow_tips;
      await page.mouse.move(tip.x, tip.y);
      await page.mouse.down();
      await page.mouse.move(tip.x + 40, tip.y - 30, { steps: 5 });
      await page.mouse.up();
      const force = before.loads[tip.load].force;
      const after = await until((now) => now.loads[tip.load].force.some((f, k) => f !== force[k]), "waited for another force");
      await until(settled, "waited for the new equilibrium");
      if (JSON.stringify(after.probes) === JSON.stringify(before.probes)) throw new Error("the body did not follow the force");
      await page.keyboard.press(undo);
      await until((now) => now.loads[tip.load].force.every((f, k) => f === force[k]), "waited for the undo");
    };
    const mac = { userAgent: "Mozilla/5.0 (Macintosh; Intel Mac OS X 10_15_7) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/140.0.0.0 Safari/537.36" };
    await onPage(browser, "?scene=article&lang=en", drag("Control+z"));
    await onPage(browser, "?scene=article&lang=en", drag("Meta+z"), mac);
  },

  async "the swing runs, and its energy drift is the native one"(browser) {
    await onPage(browser, "?scene=swing&lang=en", async ({ page, until, report }) => {
      await until((now) => now.motion.time >= 1, "waited for a second of the motion");
      await page.keyboard.press("Space");
      let now = await report();
      for (let last = -1; last !== now.motion.steps; now = await report()) {
        last = now.motion.steps;
        await page.waitForTimeout(500);
      }
      const expected = native("solve", "swing", "--json", "--set", `dynamics.duration=${now.motion.time}`);
      equal(now.motion.steps, expected.steps, "time steps");
      nearProbes(now.probes, expected.probes, 1e-6);
      if (Math.abs(now.motion.energy_drift - expected.energy_drift) > 1e-9) {
        throw new Error(`energy drift: expected ${expected.energy_drift}, got ${now.motion.energy_drift}`);
      }
    });
  },

  async "Learn's cards open one after the other"(browser) {
    await onPage(browser, "?card=1&lang=en", async ({ page, until }) => {
      const { cards } = await until((now) => now.card === 1, "waited for the first card");
      if (cards < 8) throw new Error(`${cards} cards`);
      for (let card = 2; card <= cards; card += 1) {
        await page.keyboard.press("ArrowRight");
        await until((now) => now.card === card, `waited for card ${card}`);
      }
    });
  },

  async "the page goes on while a reference solution is sought"(browser) {
    // Its reference solution takes seconds.
    await onPage(browser, "?scene=shear&lang=en", async ({ page, until }) => {
      await page.evaluate(watchPauses);
      const start = Date.now();
      await until((now) => now.is_computing, "waited for the search");
      await until((now) => !now.is_computing, "waited for the reference solution");
      const longest = await page.evaluate(() => globalThis.longest);
      console.log(`    the page stood still for at most ${longest.toFixed(0)} ms in a search of ${Date.now() - start} ms`);
      // The drawing in software takes part of this time.
      if (longest > 500) throw new Error(`the page stood still for ${longest} ms`);
    });
  },

  async "a large model is solved, and one that is too large is refused"(browser) {
    const file = join(pictures, "large.toml");
    const beam = (cells) => readFileSync("assets/scenes/article.toml", "utf8").replace(/cells = .*/, `cells = ${cells}`).replace('"warped"', '"newton"');
    const link = (toml) => `?lang=en#scene=${deflateRawSync(toml).toString("base64url")}`;
    const toml = beam("[240, 24]");
    writeFileSync(file, toml);
    const expected = native("solve", file, "--json");
    await onPage(browser, link(toml), async ({ page, until, still }) => {
      const before = await still();
      equal(before.unknowns, expected.dofs, "unknowns");
      nearProbes(before.probes, expected.probes, 1e-9);
      const [tip] = before.arrow_tips;
      await page.mouse.move(tip.x, tip.y);
      await page.mouse.down();
      await page.mouse.move(tip.x + 40, tip.y - 30, { steps: 5 });
      await page.mouse.up();
      const after = await until((now) => settled(now) && JSON.stringify(now.probes) !== JSON.stringify(before.probes), "waited for the new equilibrium");
      writeFileSync(file, toml.replace(/force = .*/, `force = [${after.loads[0].force}]`));
      nearProbes(after.probes, native("solve", file, "--json").probes, 1e-6);
    });
    const page = await browser.newPage();
    await page.goto(address + link(beam("[300, 30]")));
    await page.waitForSelector('#message[role="alert"]', { timeout: PATIENCE });
    const message = await page.textContent("#message");
    if (!message.includes("at most 16000 unknowns on a web page")) throw new Error(message);
    await page.close();
  },

  async "a study measures, and can be cancelled"(browser) {
    await onPage(browser, "?scene=article&lang=en", async ({ page, until, still }) => {
      await still();
      await page.keyboard.press("b");
      await until((now) => now.view[3] < 740, "waited for the plot of the study");
      const { view } = await still();
      const press = () => page.mouse.click(...MEASURE.map((at, axis) => view[axis ? 3 : 0] + at));
      await press();
      await until((now) => now.is_measuring, "waited for the study");
      await until((now) => now.points > 0, "waited for a measurement");
      await press();
      const now = await until((now) => !now.is_measuring, "waited for the end of the study");
      if (!(now.points > 0)) throw new Error("the measurements are lost");
    });
  },

  async "a Chinese page is Chinese"(browser) {
    await onPage(browser, "?scene=swing&lang=zh", async ({ page, until }) => {
      await until((now) => now.language === "zh" && /[\u4e00-\u9fff]/.test(now.title), "waited for a Chinese title");
      if (!/[\u4e00-\u9fff]/.test(await page.title())) throw new Error(`title: ${await page.title()}`);
    });
  },

  async "a link holds the scene"(browser) {
    await onPage(browser, "?scene=article&lang=en", async ({ page, until, still, open }) => {
      const before = await still();
      const [tip] = before.arrow_tips;
      await page.mouse.move(tip.x, tip.y);
      await page.mouse.down();
      await page.mouse.move(tip.x - 30, tip.y - 20, { steps: 5 });
      await page.mouse.up();
      const edited = await until((now) => settled(now) && JSON.stringify(now.loads) !== JSON.stringify(before.loads), "waited for the edit");
      await page.evaluate(() => navigator.clipboard.writeText(""));
      await page.keyboard.press("u");
      let link = "";
      for (const end = Date.now() + PATIENCE; !link.includes("#scene="); await page.waitForTimeout(50)) {
        if (Date.now() > end) throw new Error(`waited for a link in vain: ${link}`);
        link = await page.evaluate(() => navigator.clipboard.readText());
      }
      if (link.length > 2000) throw new Error(`the link has ${link.length} characters`);
      await page.goto("about:blank");
      await open(link.slice(address.length));
      await page.waitForFunction(() => document.body.className === "ready", null, { timeout: PATIENCE });
      const there = await until(settled, "waited for the linked scene");
      equal(JSON.stringify(there.loads), JSON.stringify(edited.loads), "loads");
      nearProbes(there.probes, edited.probes, 1e-6);
      for (const damaged of [link.slice(0, -40), `${link}!`]) {
        await page.goto("about:blank");
        await open(damaged.slice(address.length));
        await page.waitForFunction(() => document.getElementById("message").role === "alert", null, { timeout: PATIENCE });
        equal((await page.textContent("#message")).split(" (")[0], "The scene in the link cannot be read. Copy the whole link again.", "message");
      }
    });
  },

  async "files are opened, saved and kept out of a broken state"(browser) {
    const toml = readFileSync("assets/scenes/elastica.toml", "utf8");
    await onPage(browser, "?scene=article&lang=en", async ({ page, until }) => {
      const choose = async (name, text) => {
        const chooser = page.waitForEvent("filechooser");
        await page.keyboard.press("Control+o");
        await (await chooser).setFiles({ name, mimeType: "text/plain", buffer: Buffer.from(text) });
      };
      await until(settled, "waited for convergence");
      await choose("own.toml", toml);
      await until((now) => now.title.includes("own.toml") && settled(now), "waited for the chosen file");
      const download = page.waitForEvent("download");
      await page.keyboard.press("Control+s");
      const saved = await download;
      equal(saved.suggestedFilename(), "own.toml", "name of the download");
      const text = readFileSync(await saved.path(), "utf8");
      await choose("copy.toml", text);
      await until((now) => now.title.includes("copy.toml") && settled(now), "waited for the saved file");
      await choose("wrong.toml", "name = 3");
      await page.waitForTimeout(500);
      await until((now) => now.title.includes("copy.toml"), "waited for the scene to stay");
      await page.evaluate(() => {
        const data = new DataTransfer();
        data.items.add(new File(["name = 3"], "broken.toml"));
        document.dispatchEvent(new DragEvent("drop", { dataTransfer: data, cancelable: true }));
      });
      const picture = page.waitForEvent("download");
      await page.keyboard.press("s");
      equal((await picture).suggestedFilename(), "warpbeam.png", "name of the picture");
    });
  },

  async "dropped files are opened, a scene together with its mesh"(browser) {
    const expected = native("solve", "cook", "--json");
    const toml = readFileSync("assets/scenes/cook.toml", "utf8").replace("../meshes/cook.msh", "meshes/own.msh");
    const mesh = readFileSync("assets/meshes/cook.msh", "utf8");
    await onPage(browser, "?scene=article&lang=en", async ({ page, until }) => {
      const drop = (files) =>
        page.evaluate((files) => {
          const data = new DataTransfer();
          for (const [name, text] of files) data.items.add(new File([text], name));
          const event = (type) => new DragEvent(type, { dataTransfer: data, bubbles: true, cancelable: true });
          // The browser would leave the page if these events were not handled.
          const canvas = document.getElementById("warpbeam");
          return ["dragover", "drop"].map((type) => canvas.dispatchEvent(event(type)) === false);
        }, files);
      const { title } = await until(settled, "waited for convergence");
      equal(String(await drop([["own.toml", toml]])), "true,true", "handled events");
      await page.waitForTimeout(500);
      equal((await until(settled, "waited for the scene to stay")).title, title, "title after a scene without its mesh");
      await drop([["own.msh", mesh], ["own.toml", toml]]);
      const now = await until((now) => now.title.includes("own.toml") && settled(now), "waited for the dropped scene");
      equal(now.unknowns, expected.dofs, "unknowns");
      nearProbes(now.probes, expected.probes, 1e-9);
    });
  },

  async "a number is pasted into a field"(browser) {
    await onPage(browser, "?scene=article&lang=en", async ({ page, until, still }) => {
      await still();
      await page.evaluate(() => navigator.clipboard.writeText("20 kN"));
      await page.mouse.click(...FORCE);
      await page.waitForTimeout(500);
      await page.keyboard.press("Control+a");
      await page.keyboard.press("Control+v");
      await page.waitForTimeout(500);
      await page.keyboard.press("Enter");
      await until((now) => Math.abs(Math.hypot(...now.loads[0].force) - 20e3) < 1e-6, "waited for the pasted force");
    });
  },

  async "the canvas has the size and the pixels of the page"(_, backend) {
    const ratio = 2;
    // A ratio that is emulated in a page does not reach its observers of sizes.
    const browser = await chromium.launch({ executablePath: CHROMIUM, args: [...BACKENDS[backend], `--force-device-scale-factor=${ratio}`] });
    try {
      await onPage(browser, "?scene=article&lang=en", async ({ page, context, until, still }) => {
        const device = await context.newCDPSession(page);
        const { windowId } = await device.send("Browser.getWindowForTarget");
        for (const bounds of [{ width: 1000, height: 760 }, { width: 640, height: 900 }, { width: 1280, height: 800 }]) {
          await device.send("Browser.setWindowBounds", { windowId, bounds });
          await page.waitForFunction((width) => innerWidth === width, bounds.width, { timeout: PATIENCE });
          const [width, height] = await page.evaluate(() => [innerWidth, innerHeight]);
          // Any input ends the animation of the start.
          await page.mouse.move(width / 2, height - 100);
          const wanted = [ratio * width, ratio * height].join();
          await page.waitForFunction((wanted) => { const { width, height } = document.getElementById("warpbeam"); return `${width},${height}` === wanted; }, wanted, { timeout: PATIENCE });
          await until(({ view }) => view[2] <= width && view[3] <= height && view[3] > height - 200, "waited for the layout");
          const { view, body } = await still();
          const isInside = body[0] >= view[0] && body[1] >= view[1] && body[2] <= view[2] && body[3] <= view[3];
          // The longer side of the body takes a good part of the view.
          const share = Math.max((body[2] - body[0]) / (view[2] - view[0]), (body[3] - body[1]) / (view[3] - view[1]));
          if (!isInside || share < 0.3) throw new Error(`${width} × ${height}: the body at ${body} in the view ${view}`);
          await page.screenshot({ path: join(pictures, `ratio-2-${width}-${backend.replace(" ", "")}.png`) });
        }
      }, { viewport: null });
    } finally {
      await browser.close();
    }
  },

  async "settings are kept"(browser) {
    await onPage(browser, "?scene=article&lang=en", async ({ page, until }) => {
      await until(settled, "waited for convergence");
      await page.keyboard.press("p");
      await page.waitForFunction(() => (localStorage.getItem("warpbeam.settings") ?? "").includes("panel = false"), null, { timeout: PATIENCE });
      await page.reload();
      await page.waitForFunction(() => document.body.className === "ready", null, { timeout: PATIENCE });
      const { view } = await until((now) => now.view[2] - now.view[0] > 1200, "waited for a view without panel");
      if (view[2] < 1270) throw new Error(`the view ends at ${view[2]}`);
    });
  },

  async "unsaved edits are asked about and offered at the next visit"(browser) {
    await onPage(browser, "?scene=article&lang=en", async ({ page, until, still }) => {
      const before = await still();
      equal(before.offers_unsaved, false, "an offer at the first visit");
      const [tip] = before.arrow_tips;
      await page.mouse.move(tip.x, tip.y);
      await page.mouse.down();
      for (let i = 1; i <= 4; i += 1) await page.mouse.move(tip.x - 10 * i, tip.y - 8 * i);
      await page.mouse.up();
      await until((now) => JSON.stringify(now.loads) !== JSON.stringify(before.loads), "waited for another force");
      await page.waitForFunction(() => Object.keys(localStorage).some((key) => key.startsWith("warpbeam.unsaved.")), null, { timeout: PATIENCE });
      let asked = null;
      page.once("dialog", (dialog) => { asked = dialog.type(); dialog.accept(); });
      await page.reload();
      equal(asked, "beforeunload", "question before the page is left");
      await page.waitForFunction(() => document.body.className === "ready", null, { timeout: PATIENCE });
      await until((now) => now.offers_unsaved, "waited for the offer");
    });
  },

  async "one finger drags the arrow, two fingers zoom"(browser) {
    const options = { hasTouch: true };
    await onPage(browser, "?scene=article&lang=en", async ({ page, context, until, still }) => {
      const before = await still();
      const [tip] = before.arrow_tips;
      const device = await context.newCDPSession(page);
      const touch = async (type, points) => {
        await device.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
        await page.waitForTimeout(100);
      };
      await touch("touchStart", [[tip.x, tip.y]]);
      for (let i = 1; i <= 4; i += 1) await touch("touchMove", [[tip.x + 10 * i, tip.y - 8 * i]]);
      await touch("touchEnd", []);
      await until((now) => JSON.stringify(now.loads) !== JSON.stringify(before.loads), "waited for another force");
      const dragged = await still();
      await touch("touchStart", [[400, 300]]);
      await touch("touchStart", [[400, 300], [600, 300]]);
      for (let i = 1; i <= 5; i += 1) await touch("touchMove", [[400 - 15 * i, 300], [600 + 15 * i, 300]]);
      await touch("touchEnd", []);
      const zoomed = await until((now) => Math.abs(now.scale / dragged.scale - 1) > 0.2, "waited for the zoom");
      equal(JSON.stringify(zoomed.loads), JSON.stringify(dragged.loads), "loads");
    }, options);
  },

  async "a page without graphics says so"() {
    const browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox", "--disable-gpu", "--disable-3d-apis"] });
    try {
      const page = await browser.newPage();
      await page.goto(`${address}?lang=en`);
      await page.waitForSelector('#message[role="alert"]', { timeout: PATIENCE });
      const message = await page.textContent("#message");
      if (!message.includes("WebGL 2")) throw new Error(message);
    } finally {
      await browser.close();
    }
  },

  async "an idle page draws nothing"(browser) {
    await onPage(browser, "?scene=article&lang=en", async ({ page, report, until }) => {
      await until(settled, "waited for convergence");
      await page.waitForTimeout(3000);
      const first = (await report()).frames;
      await page.waitForTimeout(3000);
      const drawn = (await report()).frames - first;
      if (drawn > 2) throw new Error(`${drawn} frames in three seconds`);
    });
  },

  async "pictures are those of the native window"(browser, backend) {
    for (const [name, query, args] of [
      ["article", "?scene=article&lang=en", ["article"]],
      ["article-zh", "?scene=article&lang=zh", ["article", "--language", "zh"]],
      ["cook", "?scene=cook&lang=en", ["cook"]],
    ]) {
      const [own, expected] = [`${name}-${backend.replace(" ", "")}.png`, `${name}-native.png`].map((file) => join(pictures, file));
      execFileSync(warpbeam, ["shot", ...args, "--size", `${SIZE.width}x${SIZE.height}`, "--theme", "dark", "-o", expected]);
      await onPage(browser, query, async ({ page, until }) => {
        await until(settled, "waited for convergence");
        await page.mouse.move(900, 640);
        await page.waitForTimeout(2000);
        await page.screenshot({ path: own });
      }, { colorScheme: "dark" });
      const share = await difference(browser, [own, expected]);
      console.log(`    ${name}: ${(100 * share).toFixed(2)} % of the pixels differ`);
      if (share > 0.01) throw new Error(`${own} and ${expected} differ in ${(100 * share).toFixed(2)} % of the pixels`);
    }
  },
};

mkdirSync(pictures, { recursive: true });
const compressed = gzipSync(readFileSync(join(dist, "warpbeam_bg.wasm")), { level: 9 }).length;
console.log(`transfer of the module, compressed by gzip: ${(compressed / 1e6).toFixed(2)} MB`);
let [passed, failed] = [0, 0];
for (const [backend, args] of Object.entries(BACKENDS)) {
  if (process.env.WEB_BACKEND && process.env.WEB_BACKEND !== backend) continue;
  const browser = await chromium.launch({ executablePath: CHROMIUM, args });
  for (const [name, test] of Object.entries(TESTS)) {
    if (!name.includes(part)) continue;
    const start = Date.now();
    try {
      await test(browser, backend);
      passed += 1;
      console.log(`ok ${backend}: ${name} <${((Date.now() - start) / 1000).toFixed(1)} s>`);
    } catch (error) {
      failed += 1;
      console.log(`FAILED ${backend}: ${name}\n    ${error.message ?? error}`);
    }
  }
  await browser.close();
}
server.close();
console.log(`${passed} passed, ${failed} failed`);
process.exitCode = failed === 0 && passed > 0 ? 0 : 1;
