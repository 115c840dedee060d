//! The page around the canvas: what its script does for the window, and what it tells the window.
//!
//! `assets/web/main.js` puts an object named `stencilscope` on the page. Its functions are called here by name; the window
//! adds functions of its own to it, which the script calls.

use js_sys::{Array, Function, Reflect, Uint8Array};
use wasm_bindgen::prelude::Closure;
use wasm_bindgen::{JsCast, JsValue};

/// Returns the object through which the page's script and the window call each other; `None` on a page without it.
fn bridge() -> Option<JsValue> {
    let page = web_sys::window()?;
    Reflect::get(&page, &"stencilscope".into()).ok().filter(JsValue::is_object)
}

/// Calls a function of the page's script. A page that lacks it, or where it fails, is left as it is: the script is this
/// program's own, and the browser's console has the error.
fn call(name: &str, arguments: &[JsValue]) {
    let Some(bridge) = bridge() else { return };
    let function = Reflect::get(&bridge, &name.into()).ok().and_then(|function| function.dyn_into::<Function>().ok());
    let arguments: Array = arguments.iter().collect();
    if let Some(Err(error)) = function.map(|function| function.apply(&bridge, &arguments)) {
        web_sys::console::error_1(&error);
    }
}

/// Lets the page's script call a function of the window, for as long as the page is open.
pub fn offer(name: &str, function: Closure<dyn FnMut(JsValue) -> JsValue>) {
    if let Some(bridge) = bridge() {
        drop(Reflect::set(&bridge, &name.into(), &function.into_js_value()));
    }
}

/// Shows the window in place of the progress of loading.
pub fn show_window() {
    call("ready", &[]);
}

/// Shows why there is no window, in place of it.
pub fn show_failure(reason: &str) {
    call("failed", &[reason.into()]);
}

/// Saves a file where the browser saves what it downloads.
pub fn download(name: &str, bytes: &[u8]) {
    call("download", &[name.into(), Uint8Array::from(bytes).into()]);
}

/// Copies a text to the clipboard.
pub fn copy(text: &str) {
    call("copy", &[text.into()]);
}

/// Asks the user for files or, with `is_folder`, for a folder with all that is in it.
pub fn pick_files(is_folder: bool) {
    call("pick", &[is_folder.into()]);
}

/// Sets the page's title.
pub fn set_title(title: &str) {
    if let Some(document) = web_sys::window().and_then(|page| page.document()) {
        document.set_title(title);
    }
}

/// Returns whether a CPU draws the window.
pub fn is_cpu() -> bool {
    is_set("isCpu")
}

/// Returns whether the screen is small, as a phone's.
pub fn is_small() -> bool {
    is_set("isSmall")
}

/// Returns whether the system's theme is light.
pub fn is_light() -> bool {
    is_set("isLight")
}

fn is_set(name: &str) -> bool {
    bridge().and_then(|bridge| Reflect::get(&bridge, &name.into()).ok()).is_some_and(|value| value.is_truthy())
}

/// Returns the part of the page's address from `?` on, without it; empty where there is none.
pub fn query() -> String {
    let search = web_sys::window().and_then(|page| page.location().search().ok()).unwrap_or_default();
    search.trim_start_matches('?').to_owned()
}

/// Returns the page's address without query and fragment.
pub fn address() -> Option<String> {
    let location = web_sys::window()?.location();
    Some(format!("{}{}", location.origin().ok()?, location.pathname().ok()?))
}

/// Reads the files that the page's script hands over: a list of pairs of a path and bytes.
pub fn files_of(list: &JsValue) -> Vec<(String, Vec<u8>)> {
    let pair = |pair: JsValue| {
        let pair = pair.dyn_into::<Array>().ok()?;
        Some((pair.get(0).as_string()?, pair.get(1).dyn_into::<Uint8Array>().ok()?.to_vec()))
    };
    list.dyn_ref::<Array>().into_iter().flat_map(|list| list.iter()).filter_map(pair).collect()
}
