// Opens, prepares and traces scenes beside the page.
import load, { Worker } from "./viewer.js";

let worker;
addEventListener("message", async ({ data: { number, name, given } }) => {
  try {
    if (name == "begin") {
      await load({ module_or_path: given[0] });
      worker = new Worker();
      return postMessage({ number });
    }
    const made = worker[name](...given);
    const parts = made instanceof Array ? made : [made];
    postMessage({ number, made }, parts.filter(ArrayBuffer.isView).map((part) => part.buffer));
  } catch (error) {
    // One that a trap has stopped does nothing any more.
    postMessage({ number, error: String(error), ended: error instanceof WebAssembly.RuntimeError });
  }
});
