//! The module of the page that shows the window: `.ci/web` makes it, for browsers alone.

#[cfg(target_family = "wasm")]
fn main() {
    stencilscope::start_in_page();
}

#[cfg(not(target_family = "wasm"))]
fn main() {
    eprintln!("this is the window for a browser: make its page with .ci/web");
    std::process::exit(2);
}
