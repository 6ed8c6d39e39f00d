//! Headless Chromium over the pipe of its own debugging protocol: no driver, no port.

use serde_json::{Value, json};
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser with one page.
pub struct Chromium {
    process: Child,
    to: File,
    from: Receiver<Value>,
    session: Option<String>,
    last: u64,
    /// Addresses that were asked for, and errors of scripts.
    pub requests: Vec<String>,
    pub errors: Vec<String>,
    _folder: TempDir,
}

/// The distribution's names of it.
fn program() -> &'static str {
    let found = ["chromium", "chromium-headless-shell", "chromium-browser"]
        .into_iter()
        .find(|name| {
            let version = Command::new(name)
                .arg("--version")
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status();
            version.is_ok_and(|status| status.success())
        });
    found.expect("Chromium: apt-get install chromium-headless-shell, as tests/run does")
}

impl Chromium {
    /// A window of so many points, in light or dark.
    pub fn open(width: u32, height: u32, dark: bool) -> Self {
        let folder = TempDir::new().expect("a folder");
        let pipe = |name: &str| {
            let path = folder.path().join(name);
            let made = Command::new("mkfifo").arg(&path).status();
            assert!(made.is_ok_and(|status| status.success()), "a pipe");
            path
        };
        let (to, from) = (pipe("to"), pipe("from"));
        // The browser reads its descriptor 3 and writes 4; only a shell can give them without unsafe code.
        let process = Command::new("sh")
            .arg("-c")
            .arg("to=$1; from=$2; shift 2; exec \"$@\" 3<\"$to\" 4>\"$from\"")
            .arg("sh")
            .args([&to, &from])
            .arg(program())
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-quic",
            ])
            .args(["--no-first-run", "--disable-background-networking"])
            .args([
                "--disable-component-update",
                "--disable-sync",
                "--hide-scrollbars",
            ])
            .arg(format!(
                "--user-data-dir={}",
                folder.path().join("user").display()
            ))
            .arg("--remote-debugging-pipe")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("a shell");
        let to = File::options().write(true).open(&to).expect("its input");
        let from = File::open(&from).expect("its output");
        let (sender, receiver) = channel();
        thread::spawn(move || {
            for message in BufReader::new(from).split(0).map_while(Result::ok) {
                let value = serde_json::from_slice(&message).expect("JSON");
                if sender.send(value).is_err() {
                    break;
                }
            }
        });
        let mut browser = Self {
            process,
            to,
            from: receiver,
            session: None,
            last: 0,
            requests: Vec::new(),
            errors: Vec::new(),
            _folder: folder,
        };
        let target = browser.call("Target.createTarget", &json!({"url": "about:blank"}));
        let attached = browser.call(
            "Target.attachToTarget",
            &json!({"targetId": target["targetId"], "flatten": true}),
        );
        browser.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Network"] {
            browser.call(&format!("{domain}.enable"), &json!({}));
        }
        let scheme = if dark { "dark" } else { "light" };
        browser.call(
            "Emulation.setEmulatedMedia",
            &json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]}),
        );
        browser.resize(width, height);
        browser
    }

    /// The window's size; below 600 points it is a phone's, with a finger.
    pub fn resize(&mut self, width: u32, height: u32) {
        let phone = width < 600;
        self.call(
            "Emulation.setDeviceMetricsOverride",
            &json!({"width": width, "height": height, "deviceScaleFactor": if phone { 2 } else { 1 }, "mobile": phone}),
        );
        self.call(
            "Emulation.setTouchEmulationEnabled",
            &json!({"enabled": phone}),
        );
    }

    /// A call of the protocol, and its answer.
    pub fn call(&mut self, method: &str, parameters: &Value) -> Value {
        self.last += 1;
        let mut message = json!({"id": self.last, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        self.to.write_all(&bytes).expect("it lives");
        loop {
            let answer = self
                .next(PATIENCE)
                .unwrap_or_else(|| panic!("{method}: no answer"));
            if answer["id"] == json!(self.last) {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
        }
    }

    fn next(&mut self, patience: Duration) -> Option<Value> {
        match self.from.recv_timeout(patience) {
            Ok(message) => {
                match message["method"].as_str() {
                    Some("Network.requestWillBeSent") => {
                        let url = message["params"]["request"]["url"].as_str();
                        self.requests.push(url.unwrap_or_default().to_owned());
                    }
                    Some("Runtime.exceptionThrown") => {
                        let details = &message["params"]["exceptionDetails"];
                        self.errors.push(details.to_string());
                    }
                    _ => {}
                }
                Some(message)
            }
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => panic!("the browser has ended"),
        }
    }

    /// Goes to an address, and waits until the page has drawn its first picture.
    pub fn go(&mut self, address: &str) {
        self.call("Page.navigate", &json!({"url": address}));
        self.until("document.documentElement?.dataset.first > 0");
    }

    /// Of a file.
    pub fn go_to_file(&mut self, path: &Path, fragment: &str) {
        self.go(&format!("file://{}{fragment}", path.display()));
    }

    /// What an expression gives, promises awaited.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let answer = self.call(
            "Runtime.evaluate",
            &json!({"expression": expression, "awaitPromise": true, "returnByValue": true}),
        );
        assert!(
            answer["exceptionDetails"].is_null(),
            "{expression}: {answer}"
        );
        answer["result"]["value"].clone()
    }

    /// A number.
    pub fn number(&mut self, expression: &str) -> f64 {
        let value = self.evaluate(expression);
        value
            .as_f64()
            .unwrap_or_else(|| panic!("{expression} is {value}"))
    }

    /// Waits until an expression is true.
    pub fn until(&mut self, expression: &str) {
        let begun = Instant::now();
        while self.evaluate(&format!("!!({expression})")) != json!(true) {
            assert!(begun.elapsed() < PATIENCE, "never: {expression}");
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// Presses, moves in steps, lets go; by mouse.
    pub fn drag(&mut self, from: (f64, f64), to: (f64, f64)) {
        let mut event = |kind: &str, (x, y): (f64, f64), buttons: u32| {
            self.call(
                "Input.dispatchMouseEvent",
                &json!({"type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1}),
            );
        };
        event("mouseMoved", from, 0);
        event("mousePressed", from, 1);
        for step in 1..=8 {
            let share = f64::from(step) / 8.0;
            let between = |a: f64, b: f64| a + share * (b - a);
            event(
                "mouseMoved",
                (between(from.0, to.0), between(from.1, to.1)),
                1,
            );
        }
        event("mouseReleased", to, 0);
    }

    /// The same by finger.
    pub fn drag_by_finger(&mut self, from: (f64, f64), to: (f64, f64)) {
        let mut event = |kind: &str, points: Value| {
            self.call(
                "Input.dispatchTouchEvent",
                &json!({"type": kind, "touchPoints": points}),
            );
        };
        event("touchStart", json!([{"x": from.0, "y": from.1}]));
        for step in 1..=8 {
            let share = f64::from(step) / 8.0;
            let between = |a: f64, b: f64| a + share * (b - a);
            event(
                "touchMove",
                json!([{"x": between(from.0, to.0), "y": between(from.1, to.1)}]),
            );
        }
        event("touchEnd", json!([]));
    }

    /// Holds a key for a while.
    pub fn key(&mut self, key: &str, modifiers: u32, hold: Duration) {
        let text = if key.chars().count() == 1 { key } else { "" };
        self.call(
            "Input.dispatchKeyEvent",
            &json!({"type": "keyDown", "key": key, "text": text, "modifiers": modifiers}),
        );
        thread::sleep(hold);
        self.call(
            "Input.dispatchKeyEvent",
            &json!({"type": "keyUp", "key": key, "modifiers": modifiers}),
        );
    }

    /// A picture of what is seen.
    pub fn picture(&mut self, path: &Path) {
        let taken = self.call("Page.captureScreenshot", &json!({"format": "png"}));
        let text = taken["data"].as_str().expect("a picture");
        let bytes = self.evaluate_base64(text);
        std::fs::write(path, bytes).expect("written");
    }

    /// The browser knows base64.
    fn evaluate_base64(&mut self, text: &str) -> Vec<u8> {
        let value = self.evaluate(&format!("[...fromBase64({})]", json!(text)));
        let numbers = value.as_array().expect("numbers");
        numbers
            .iter()
            .filter_map(|n| n.as_u64().map(|n| n as u8))
            .collect()
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        // It ends with its pipe; a test that failed does not wait for that.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
