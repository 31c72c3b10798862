//! `adapters`: what wgpu finds here.

use super::table::Report;
use subpixel_shadows::gpu::{AdapterSummary, Gpu};
use subpixel_shadows::{Error, Result, wgpu};

/// Lists every adapter, or with `check` only finds out whether the one `render` would take can be opened.
pub fn run(check: bool) -> Result<()> {
    if check {
        return Gpu::open(None).and_then(|gpu| gpu.check());
    }
    let all = Gpu::adapters();
    if all.is_empty() {
        return Err(Error::NoAdapter("none was found; render takes the CPU engine".to_owned()));
    }
    let mut report = Report::default();
    for (k, adapter) in all.iter().enumerate() {
        if k > 0 {
            report.text("");
        }
        describe(&mut report, adapter);
    }
    report.print()
}

fn describe(report: &mut Report, adapter: &wgpu::Adapter) {
    let summary = AdapterSummary::of(&adapter.get_info());
    let (features, limits) = (adapter.features(), adapter.limits());
    let yes = |feature| if features.contains(feature) { "yes" } else { "no" };
    report.line("adapter", &summary.name);
    report.line("backend", &summary.backend);
    report.line("driver", &summary.driver);
    report.line("kind", if summary.software { "software, runs on the CPU" } else { "hardware" });
    report.line(
        "features",
        &format!(
            "time stamps {}, subgroups {}, 64-bit atomics {}",
            yes(wgpu::Features::TIMESTAMP_QUERY),
            yes(wgpu::Features::SUBGROUP),
            yes(wgpu::Features::SHADER_INT64_ATOMIC_ALL_OPS)
        ),
    );
    report.line(
        "limits",
        &format!(
            "binding {} MiB, buffer {} MiB, {} storage buffers a stage, {} invocations a workgroup",
            limits.max_storage_buffer_binding_size >> 20,
            limits.max_buffer_size >> 20,
            limits.max_storage_buffers_per_shader_stage,
            limits.max_compute_invocations_per_workgroup
        ),
    );
    let path = match Gpu::from_adapter(adapter, None).and_then(|gpu| gpu.check()) {
        Ok(()) if features.contains(wgpu::Features::TIMESTAMP_QUERY) => {
            "GPU engine, with the time of each stage".into()
        }
        Ok(()) => "GPU engine, without the time of each stage".into(),
        Err(error) => format!("none: {error}"),
    };
    report.line("path", &path);
}
