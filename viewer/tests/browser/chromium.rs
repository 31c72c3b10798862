//! Chromium without a screen, told what to do through a pipe (DevTools protocol).

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use test_support::Folder;

/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(300);

/// WebGPU on SwiftShader, Chromium's own software adapter. Without the last one a canvas cannot be presented on it.
const WEBGPU: [&str; 9] = [
    "--enable-unsafe-webgpu",
    "--ignore-gpu-blocklist",
    "--disable-gpu-sandbox",
    "--disable-gpu-watchdog",
    "--use-webgpu-adapter=swiftshader",
    "--use-angle=swiftshader",
    "--use-vulkan=swiftshader",
    "--enable-features=Vulkan",
    "--disable-vulkan-surface",
];

/// A browser with one tab.
pub struct Chromium {
    child: Child,
    to: ChildStdin,
    from: Receiver<Value>,
    next: u64,
    session: Option<String>,
    /// Errors of the page's scripts, and what they wrote to the console.
    pub heard: Vec<String>,
    _folder: Folder,
}

impl Chromium {
    /// A browser with WebGPU.
    pub fn start(name: &str, size: [u32; 2]) -> Self {
        Self::with(name, size, &WEBGPU)
    }

    /// A browser without WebGPU.
    pub fn without_webgpu(name: &str, size: [u32; 2]) -> Self {
        Self::with(name, size, &["--disable-features=WebGPU,WebGPUService", "--disable-gpu"])
    }

    fn with(name: &str, [width, height]: [u32; 2], flags: &[&str]) -> Self {
        let folder = Folder::new(&format!("browser-{name}"));
        // It reads from 3 and writes to 4.
        let shell = "exec chromium \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>/dev/null";
        let mut child = Command::new("sh")
            .args(["-c", shell, "chromium", "--headless=new", "--no-sandbox", "--remote-debugging-pipe"])
            .args(flags)
            .arg(format!("--user-data-dir={}", folder.path("profile")))
            .arg(format!("--window-size={width},{height}"))
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("sh");
        let to = child.stdin.take().expect("a pipe");
        let mut out = BufReader::new(child.stdout.take().expect("a pipe"));
        let (send, from) = channel();
        std::thread::spawn(move || {
            let mut bytes = Vec::new();
            while out.read_until(0, &mut bytes).is_ok_and(|n| n > 0) {
                bytes.pop();
                let message = serde_json::from_slice(&bytes).expect("JSON");
                bytes.clear();
                if send.send(message).is_err() {
                    break;
                }
            }
        });
        let mut browser = Self { child, to, from, next: 0, session: None, heard: Vec::new(), _folder: folder };
        let known = browser.call("Target.getTargets", json!({}));
        let tab = known["targetInfos"].as_array().and_then(|all| all.iter().find(|t| t["type"] == "page").cloned());
        browser.session = browser.attach(&tab.expect("a tab")["targetId"]);
        for domain in ["Runtime.enable", "Page.enable", "Log.enable"] {
            browser.call(domain, json!({}));
        }
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        browser.call("Emulation.setDeviceMetricsOverride", metrics);
        browser
    }

    /// The session of a tab.
    fn attach(&mut self, target: &Value) -> Option<String> {
        let attached = self.call("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        attached["sessionId"].as_str().map(ToOwned::to_owned)
    }

    /// Calls a method of the protocol.
    pub fn call(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let mut message = json!({ "id": self.next, "method": method, "params": params });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        let mut bytes = serde_json::to_vec(&message).expect("JSON");
        bytes.push(0);
        self.to.write_all(&bytes).expect("chromium, which `./web.sh --test` installs on Debian and Ubuntu");
        let start = Instant::now();
        loop {
            let left = PATIENCE.saturating_sub(start.elapsed());
            let message = self.from.recv_timeout(left).unwrap_or_else(|e| panic!("{method}: {e}; {:?}", self.heard));
            if message["id"] == json!(self.next) {
                assert!(message["error"].is_null(), "{method}: {}", message["error"]);
                return message["result"].clone();
            }
            self.hear(&message);
        }
    }

    fn hear(&mut self, message: &Value) {
        let params = &message["params"];
        match message["method"].as_str() {
            Some("Runtime.consoleAPICalled") => {
                let words = params["args"].as_array().into_iter().flatten();
                let words = words.map(|a| a["value"].as_str().or(a["description"].as_str()).unwrap_or_default());
                self.heard.push(words.collect::<Vec<_>>().join(" "));
            }
            Some("Runtime.exceptionThrown") => self.heard.push(params["exceptionDetails"].to_string()),
            _ => {}
        }
    }

    /// Opens an address and waits until it is loaded.
    pub fn open(&mut self, address: &str) {
        // The same page with another view is loaded anew.
        self.call("Page.navigate", json!({ "url": "about:blank" }));
        self.call("Page.navigate", json!({ "url": address }));
        self.until("the page is loaded", "document.readyState == 'complete' && location.href != 'about:blank'");
    }

    /// The value of an expression or of what it promises.
    pub fn try_value(&mut self, expression: &str) -> Result<Value, String> {
        let ask = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let answer = self.call("Runtime.evaluate", ask);
        match &answer["exceptionDetails"] {
            Value::Null => Ok(answer["result"]["value"].clone()),
            thrown => Err(match &thrown["exception"]["value"] {
                Value::String(text) => text.clone(),
                _ => thrown["exception"]["description"].as_str().unwrap_or("an exception").to_owned(),
            }),
        }
    }

    /// [`Self::try_value`] of what throws nothing.
    pub fn value(&mut self, expression: &str) -> Value {
        self.try_value(expression).unwrap_or_else(|e| panic!("{expression}: {e}; {:?}", self.heard))
    }

    /// Waits until an expression is true.
    pub fn until(&mut self, what: &str, expression: &str) {
        let start = Instant::now();
        while self.try_value(expression) != Ok(json!(true)) {
            let panicked = self.heard.iter().find(|line| line.contains("panicked"));
            assert!(panicked.is_none(), "{what}: {panicked:?}");
            assert!(start.elapsed() < PATIENCE, "not so after {PATIENCE:?}: {what}; {:?}", self.heard);
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Presses at a place, moves to another, and lets go.
    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.mouse(event("mouseMoved", from, 0));
        self.mouse(event("mousePressed", from, 1));
        for step in 1..=4 {
            let share = f64::from(step) / 4.0;
            self.mouse(event("mouseMoved", [0, 1].map(|k| from[k] + (to[k] - from[k]) * share), 1));
        }
        self.mouse(event("mouseReleased", to, 0));
    }

    /// Clicks at a place. No frame is waited for in between: what is held for longer than 0.8 s is no click, and a frame may take as long.
    pub fn click(&mut self, at: [f64; 2]) {
        self.mouse(event("mouseMoved", at, 0));
        self.call("Input.dispatchMouseEvent", event("mousePressed", at, 1));
        self.mouse(event("mouseReleased", at, 0));
    }

    /// Ends the browser's GPU process, as a driver that fails does.
    pub fn lose_gpu(&mut self) {
        // The browser is asked, not the page.
        let session = self.session.take();
        self.call("Browser.crashGpuProcess", json!({}));
        self.session = session;
    }

    fn mouse(&mut self, event: Value) {
        self.call("Input.dispatchMouseEvent", event);
        // The page looks at its events once a frame.
        self.value("new Promise(seen => requestAnimationFrame(() => requestAnimationFrame(() => seen(true))))");
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        // It may have ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A mouse event with the left button, or none.
fn event(kind: &str, [x, y]: [f64; 2], buttons: u32) -> Value {
    let button = if buttons > 0 || kind == "mouseReleased" { "left" } else { "none" };
    json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1 })
}
