// Worker of the page: an instance of the module of its own, which does the work that the page requests.
import init from "./warpbeam.js";

let ready;

// The first message is the compiled module of the page; the others are requests: a name, and its data.
onmessage = async ({ data }) => {
  if (data instanceof WebAssembly.Module) {
    ready = init({ module_or_path: data });
    return;
  }
  try {
    await ready;
    globalThis.warpbeam_work(...data);
  } catch (error) {
    // An error of an asynchronous function does not reach the page by itself.
    setTimeout(() => { throw error; });
  }
};
