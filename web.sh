#!/bin/sh
# The viewer as a web page: static files in out/web, or the folder that is given. To look at it: python3 -m http.server -d out/web
set -eu
cd "$(dirname "$0")"
rustup target add wasm32-unknown-unknown
cargo build --profile web --target wasm32-unknown-unknown -p subpixel-shadows-viewer --lib --no-default-features
cargo run --release --quiet -p subpixel-shadows-page -- \
    "${CARGO_TARGET_DIR:-target}/wasm32-unknown-unknown/web/viewer.wasm" "${1:-out/web}"
