// Loads the window, and does for it what only a page can: downloads, file dialogs, drops.

const start = document.getElementById("start");
const state = document.getElementById("state");
const progress = document.getElementById("progress");
let failed = false;

// The window calls these by name, and adds `open`, `isTooLarge`, `did`, `refused` and `tree` (src/app/browser/page.rs).
globalThis.stencilscope = {
  isLight: matchMedia("(prefers-color-scheme: light)").matches,
  isSmall: Math.min(innerWidth, innerHeight) < 500,
  ready() {
    start.hidden = true;
    document.getElementById("window").focus();
  },
  failed(reason) {
    if (failed) {
      return;
    }
    failed = true;
    document.body.classList.add("failed");
    state.textContent = reason;
    state.className = "failed";
    progress.hidden = true;
    start.hidden = false;
    // The canvas is hidden, and may have had it.
    state.focus();
  },
  download(name, bytes) {
    const url = URL.createObjectURL(new Blob([bytes]));
    const link = document.createElement("a");
    link.href = url;
    link.download = name;
    link.click();
    // The browser has begun to read it by then.
    setTimeout(() => URL.revokeObjectURL(url), 60_000);
  },
  copy(text) {
    const live = globalThis.stencilscope;
    const fail = (error) => live.refused(`the link could not be copied: ${error.message || error}; it is ${text}`);
    navigator.clipboard.writeText(text).then(() => live.did("copied a link to this view"), fail);
  },
  pick(isFolder) {
    const input = document.createElement("input");
    input.type = "file";
    input.multiple = true;
    input.webkitdirectory = isFolder;
    input.addEventListener("change", () => {
      openFiles([...input.files].map((file) => [file.webkitRelativePath || file.name, file]));
    });
    input.click();
  },
};

// Hands files over to the window: pairs of a path and a File.
async function openFiles(files) {
  const live = globalThis.stencilscope;
  const bytes = files.reduce((sum, [, file]) => sum + file.size, 0);
  // What does not fit into memory is not read into it.
  if (!live.open || live.isTooLarge(bytes)) {
    return;
  }
  const read = async ([path, file]) => [path, new Uint8Array(await file.arrayBuffer())];
  try {
    live.open(await Promise.all(files.map(read)));
  } catch (error) {
    live.refused(`the files could not be read: ${error.message || error}`);
  }
}

// All files in a dropped folder, at any depth.
async function filesIn(entry, path) {
  if (entry.isFile) {
    return [[path + entry.name, await new Promise((resolve, reject) => entry.file(resolve, reject))]];
  }
  const reader = entry.createReader();
  const files = [];
  for (;;) {
    // A reader gives a hundred entries at a time.
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) {
      return files;
    }
    for (const inner of some) {
      files.push(...(await filesIn(inner, `${path}${entry.name}/`)));
    }
  }
}

function listenForDrops() {
  const drop = document.getElementById("drop");
  const isFiles = (event) => [...event.dataTransfer.types].includes("Files");
  const handle = (event, isOver) => {
    if (isFiles(event)) {
      event.preventDefault();
      drop.hidden = !isOver;
    }
  };
  document.addEventListener("dragenter", (event) => handle(event, true), true);
  document.addEventListener("dragover", (event) => handle(event, true), true);
  document.addEventListener("dragleave", (event) => handle(event, event.relatedTarget !== null), true);
  document.addEventListener(
    "drop",
    async (event) => {
      handle(event, false);
      event.stopPropagation();
      // The items are gone once this function waits. Not every source of files gives entries, which alone know folders.
      const items = [...event.dataTransfer.items].filter((item) => item.kind === "file");
      const dropped = items.map((item) => [item.webkitGetAsEntry(), item.getAsFile()]);
      const all = ([entry, file]) => (entry ? filesIn(entry, "") : [[file.name, file]]);
      try {
        const files = await Promise.all(dropped.map(all));
        if (files.flat().length > 0) {
          await openFiles(files.flat());
        }
      } catch (error) {
        globalThis.stencilscope.refused?.(`the files could not be read: ${error.message || error}`);
      }
    },
    true,
  );
}

// The module as it comes, compiled meanwhile; the bar says how much has come.
async function fetched(url, bytes) {
  const response = await fetch(url);
  if (!response.ok) {
    throw new Error(`${url}: ${response.status} ${response.statusText}`);
  }
  let count = 0;
  const counter = new TransformStream({
    transform(chunk, out) {
      count += chunk.length;
      if (count < bytes) {
        progress.value = count / bytes;
      } else {
        state.textContent = "Starting…";
        progress.removeAttribute("value");
      }
      out.enqueue(chunk);
    },
  });
  return new Response(response.body.pipeThrough(counter), { headers: { "content-type": "application/wasm" } });
}

// What the shader that draws the window asks of its uniforms, and the answers: egui's own filter, and no dithering.
const CHOICES = [
  ["r_locals.predictable_texture_filtering == 0", "true"],
  ["r_locals.dithering == 1", "false"],
];

// Takes out of that shader what is not chosen. A GPU skips it; a CPU in a GPU's place computes it for every pixel, which takes
// most of a frame's time.
function simplifyShaders() {
  const { prototype } = globalThis.GPUDevice;
  const make = prototype.createShaderModule;
  prototype.createShaderModule = function (descriptor) {
    const code = CHOICES.reduce((text, [question, answer]) => text.replaceAll(question, answer), descriptor.code);
    globalThis.stencilscope.hasSimplified ||= code !== descriptor.code;
    return make.call(this, { ...descriptor, code });
  };
}

async function run() {
  // A file that is dropped elsewhere would replace the page.
  listenForDrops();
  const adapter = await navigator.gpu?.requestAdapter().catch(() => null);
  if (!adapter) {
    globalThis.stencilscope.failed(
      "This browser has no WebGPU, which the window needs: use a current Chrome, Edge, Safari or Firefox, on a page that " +
        "is served by https or from this machine. The recorded frame below works without it.",
    );
    return;
  }
  globalThis.stencilscope.isCpu = adapter.info?.isFallbackAdapter;
  if (globalThis.stencilscope.isCpu) {
    simplifyShaders();
  }
  const { default: init } = await import("./stencilscope.js");
  await init({ module_or_path: fetched("stencilscope_bg.wasm", Number(progress.dataset.bytes)) });
}

run().catch((error) => {
  globalThis.stencilscope.failed(`The window could not be loaded: ${error.message || error}. Load the page again.`);
});
