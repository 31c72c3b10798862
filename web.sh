#!/bin/sh
# The viewer as a web page: static files in out/web, or the folder that is given. To look at it: python3 -m http.server -d out/web
# `./web.sh --test` makes it and tries it in Chromium, which it installs where it is missing (Debian, Ubuntu).
set -eu
cd "$(dirname "$0")"
if [ "${1:-}" = --test ]; then
    if ! command -v chromium >/dev/null 2>&1; then
        root=$([ "$(id -u)" = 0 ] || echo sudo)
        $root apt-get update
        $root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends chromium
    fi
    exec cargo test --release --workspace --exclude subpixel-shadows-page --test browser -- --ignored --test-threads=1 --nocapture
fi
rustup target add wasm32-unknown-unknown
# Every browser that has WebGPU has these instructions; without them, the code that draws letters is three times as long.
RUSTFLAGS="-C target-feature=+simd128" \
    cargo build --profile web --target wasm32-unknown-unknown -p subpixel-shadows-viewer --lib --no-default-features
cargo run --release --quiet -p subpixel-shadows-page -- \
    "${CARGO_TARGET_DIR:-target}/wasm32-unknown-unknown/web/viewer.wasm" "${1:-out/web}"
