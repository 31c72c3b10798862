//! How frames of the pass came out.

use subpixel_shadows::ShadowPass;
use subpixel_shadows::pass::FrameStatus;

/// How the oldest frame came out that was not asked for. The poll of another test may still be telling: wait for it.
pub fn status_of(pass: &mut ShadowPass) -> FrameStatus {
    for _ in 0..5000 {
        if let Some(status) = pass.status() {
            return status;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    panic!("not known seconds after the frame ran");
}
