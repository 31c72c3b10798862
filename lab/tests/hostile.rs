//! Files that are damaged, or made to do harm: each is read, or refused in one line that names it.

#[path = "shared/hostile.rs"]
mod hostile;

use hostile::{Folder, Random, gltf_buffer, is_one_line_that_names, sound, write_companions};
use lab::scene::{Scene, SceneOptions, load};
use oracle::engine::{self, CpuRequest};
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};
use subpixel_shadows::methods::Settings;
use subpixel_shadows::samples::{Pattern, Samples};
use test_support::gpu_test;

fn settings() -> Settings {
    Settings { cull_back: true, ..Settings::new([12, 9], 12, Samples::new(Pattern::LowDiscrepancy, 8).unwrap()) }
}

/// Opens and renders; the message if it is refused.
fn render(path: &Path) -> Result<usize, String> {
    let run = || {
        let scene = Scene::open(path.to_str().expect("UTF-8"), &SceneOptions::default())?;
        let frame =
            engine::render(&scene.prepared()?, &settings(), &scene.camera, &scene.light, CpuRequest::default())?;
        assert!(frame.output.visibility.iter().all(|v| (0.0..=1.0).contains(v)), "{}", path.display());
        Ok(scene.mesh.triangles.len())
    };
    run().map_err(|e: subpixel_shadows::Error| e.to_string())
}

fn program(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_subpixel-shadows")).args(args).output().expect("the program starts")
}

#[test]
fn sound_files_are_read_whole() {
    let folder = Folder::new("sound").unwrap();
    write_companions(&folder.0).unwrap();
    for file in sound() {
        let path = folder.0.join("box").with_extension(file.extension);
        std::fs::write(&path, &file.bytes).unwrap();
        let triangles = render(&path).unwrap_or_else(|e| panic!("{}: {e}", file.format));
        let expected = match file.format {
            "ply, text" => 17,
            "ply, little endian" | "ply, big endian" => 17 + 2,
            "obj" => 17 + 2,
            "toml, of a mesh" => 17 + 2 + 2,
            "toml, built in" => 113,
            // The box, the strip and the fan.
            _ => 17 + 2 + 2,
        };
        assert_eq!(triangles, expected, "{}", file.format);
    }
}

/// `cargo run --release --example hostile` does the same with more files, through the program and on the GPU, too.
#[test]
fn damaged_files_are_read_or_refused_in_one_line() {
    let folder = Folder::new("damaged").unwrap();
    write_companions(&folder.0).unwrap();
    let (sound, mut random) = (sound(), Random::new(28));
    let (start, mut read, mut refused) = (Instant::now(), 0, 0);
    for case in 0..4000 {
        if start.elapsed() > Duration::from_secs(120) {
            break;
        }
        let (which, bytes) = hostile::hostile(&sound, &mut random);
        let name = format!("{case}.{}", sound[which].extension);
        let path = folder.0.join(&name);
        std::fs::write(&path, &bytes).unwrap();
        match render(&path) {
            Ok(_) => read += 1,
            Err(message) => {
                assert!(is_one_line_that_names(&message, &name), "{name}: {message}");
                refused += 1;
            }
        }
        if case % 100 == 0 {
            let (out, path) = (folder.0.join("out"), path.to_str().unwrap());
            let small = ["--engine", "cpu", "--size", "8x6", "--map", "8", "--samples", "8", "--quiet", "--out"];
            let done = program(&[&["render", path], &small[..], &[out.to_str().unwrap()]].concat());
            let line = String::from_utf8_lossy(&done.stderr);
            assert!(matches!(done.status.code(), Some(0 | 1)), "{name}: {:?} {line}", done.status);
            assert_eq!(done.status.success(), out.exists(), "{name}");
            assert_eq!(line.lines().count(), usize::from(!done.status.success()), "{name}: {line}");
            let _ = std::fs::remove_dir_all(out);
        }
        std::fs::remove_file(path).unwrap();
    }
    assert!(read > 200 && refused > 200, "{read} read, {refused} refused");
}

/// A glTF file of the given parts beside a buffer that holds a tetrahedron.
fn gltf(folder: &Folder, name: &str, nodes: &str, primitive: &str, extra: &str) -> std::path::PathBuf {
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{},"uri":"box.bin"}}],
        "bufferViews":[{{"buffer":0,"byteLength":204}},{{"buffer":0,"byteOffset":204,"byteLength":102}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":17,"type":"VEC3"}},
        {{"bufferView":1,"componentType":5123,"count":51,"type":"SCALAR"}}],
        "meshes":[{{"name":"chair","primitives":[{primitive}]}}],"nodes":{nodes}{extra}}}"#,
        gltf_buffer().len()
    );
    let path = folder.0.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

const BOX: &str = r#"{"attributes":{"POSITION":0},"indices":1}"#;

/// What a file holds that is not read is said in one note, and by the program in one line, which `--quiet` leaves out.
#[test]
fn what_is_not_read_is_said_in_one_note() {
    let folder = Folder::new("notes").unwrap();
    write_companions(&folder.0).unwrap();
    let file = |name: &str, text: &str| {
        std::fs::write(folder.0.join(name), text).unwrap();
        folder.0.join(name)
    };
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nelement edge 2\nproperty int a\n\
        element none 0\nproperty int a\n\
        end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n4\n5\n";
    let morphed = r#"{"attributes":{"POSITION":0},"indices":1,"targets":[{"POSITION":0},{}]},
        {"attributes":{"POSITION":0},"mode":0}"#;
    let more = r#","skins":[{"joints":[0]},{"joints":[0]}],"animations":[{"channels":[],"samplers":[]}],"textures":[{}],
        "materials":[{"alphaMode":"BLEND"},{"alphaMode":"OPAQUE"},{}],"scene":0,"scenes":[{"nodes":[0]},{"nodes":[]}],
        "cameras":[{"type":"orthographic","orthographic":{}}],
        "extensionsUsed":["EXT_mesh_gpu_instancing","KHR_materials_unlit"]"#;
    let many: Vec<String> = (0..14).map(|k| format!("\"EXT_{k}\"")).collect();
    let many = format!(r#","extensionsUsed":[{}]"#, many.join(","));
    let some: &[(std::path::PathBuf, Option<&str>)] = &[
        (file("plain.obj", triangle), None),
        (
            file("more.obj", &format!("mtllib a.mtl\nusemtl a\n{triangle}l 1 2\np 1\ncurv 0 1 1 2\nusemtl b\n")),
            Some("2 statements of points or lines, 2 uses of materials and 1 free-form curve or surface"),
        ),
        (file("edges.ply", ply), Some("2 rows of element 'edge'")),
        (
            file("of.toml", "mesh = \"more.obj\"\n"),
            Some("2 statements of points or lines, 2 uses of materials and 1 free-form curve or surface"),
        ),
        (gltf(&folder, "plain.gltf", r#"[{"mesh":0}]"#, BOX, ""), None),
        (
            gltf(&folder, "more.gltf", r#"[{"mesh":0,"skin":0}]"#, morphed, more),
            Some(
                "2 skins, 1 animation, 1 primitive's morph targets, 1 primitive of points or lines, 1 texture, \
                1 see-through material, taken as opaque, 1 other scene, \
                1 camera without perspective and extension 'EXT_mesh_gpu_instancing'",
            ),
        ),
        (
            gltf(&folder, "many.gltf", r#"[{"mesh":0}]"#, BOX, &many),
            Some(
                "extension 'EXT_0', extension 'EXT_1', extension 'EXT_2', extension 'EXT_3', extension 'EXT_4', \
                extension 'EXT_5', \
                extension 'EXT_6', extension 'EXT_7', extension 'EXT_8', extension 'EXT_9' and 4 other kinds",
            ),
        ),
    ];
    let out = folder.0.join("out");
    for (path, expected) in some {
        let loaded = load(path).unwrap();
        assert_eq!(loaded.note(), expected.map(|e| format!("not read: {e}")), "{}", path.display());
        let arguments = |quiet| {
            let all = [
                "render",
                path.to_str().unwrap(),
                "--engine",
                "cpu",
                "--size",
                "8x6",
                "--map",
                "8",
                "--out",
                out.to_str().unwrap(),
            ];
            [&all[..], quiet].concat()
        };
        let lines = |done: Output| {
            assert!(done.status.success(), "{}", path.display());
            String::from_utf8(done.stderr).unwrap()
        };
        let note = expected.map_or(String::new(), |e| format!("subpixel-shadows: {}: not read: {e}\n", path.display()));
        assert_eq!(lines(program(&arguments(&[]))), note);
        assert_eq!(lines(program(&arguments(&["--quiet"]))), "");
    }
}

/// Compressed meshes are refused if the file requires the extension, and by what is missing if it does not.
#[test]
fn compressed_and_distant_data_is_refused_by_name() {
    let folder = Folder::new("distant").unwrap();
    write_companions(&folder.0).unwrap();
    let node = r#"[{"mesh":0}]"#;
    let refused = |name: &str, primitive: &str, extra: &str, from: &str, to: &str, message: &str| {
        let path = gltf(&folder, name, node, primitive, extra);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{name}: {from}");
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let error = load(&path).map(|l| l.mesh.triangles.len()).unwrap_err().to_string();
        assert_eq!(error, format!("{}: {message}", path.display()));
    };
    let draco = r#"{"attributes":{"POSITION":0},"indices":1,
        "extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{}}}}"#;
    let required = |e: &str| format!(r#","extensionsUsed":["{e}"],"extensionsRequired":["{e}"]"#);
    refused(
        "draco.gltf",
        draco,
        &required("KHR_draco_mesh_compression"),
        "",
        "",
        "glTF: requires extension 'KHR_draco_mesh_compression', which is not read",
    );
    refused(
        "meshopt.gltf",
        BOX,
        &required("EXT_meshopt_compression"),
        "",
        "",
        "glTF: requires extension 'EXT_meshopt_compression', which is not read",
    );
    // Accessors of compressed data have no view of their own, and no count of the file's backs them.
    let view = r#""bufferView":0,"componentType":5126,"count":17"#;
    refused(
        "noview.gltf",
        draco,
        "",
        view,
        r#""componentType":5126,"count":4000000000"#,
        "glTF: accessor 0 has 4000000000 elements and no data, all buffers hold 360 bytes",
    );
    refused("fallback.gltf", BOX, "", r#","uri":"box.bin""#, "", "glTF: buffer 0 of 360 bytes has no data");
    let uri = r#""uri":"box.bin""#;
    for (name, to) in [
        ("http.gltf", "https://example.org/box.bin"),
        ("up.gltf", "../box.bin"),
        ("inside.gltf", "a/../../box.bin"),
        ("root.gltf", "/etc/passwd"),
        ("drive.gltf", "C:box.bin"),
    ] {
        let message = format!("glTF: buffer 0: path '{to}' is not a relative path that stays in the folder");
        refused(name, BOX, "", uri, &format!(r#""uri":"{to}""#), &message);
    }
    let gone = folder.0.join("none.bin").display().to_string();
    refused(
        "gone.gltf",
        BOX,
        "",
        uri,
        r#""uri":"none.bin""#,
        &format!("glTF: buffer 0: {gone}: No such file or directory (os error 2)"),
    );
}

/// What stands at rest, mirrored or flattened to nothing is read as it is.
#[test]
fn odd_nodes_are_placed() {
    let folder = Folder::new("nodes").unwrap();
    write_companions(&folder.0).unwrap();
    let count = |name: &str, nodes: &str| {
        let path = gltf(&folder, name, nodes, BOX, "");
        render(&path).unwrap_or_else(|e| panic!("{e}"))
    };
    // 3,000 nodes deep, each turned a little and half of them mirrored; the mesh at the end.
    let deep: Vec<String> = (1..3000)
        .map(|k| format!(r#"{{"children":[{k}],"rotation":[0,0.01,0,1],"scale":[{},1,1]}}"#, 1 - 2 * (k % 2)))
        .collect();
    assert_eq!(count("deep.gltf", &format!("[{},{{\"mesh\":0}}]", deep.join(","))), 17);
    assert_eq!(count("mirrored.gltf", r#"[{"mesh":0,"scale":[-1,-1,-1]}]"#), 17);
    assert_eq!(count("zero.gltf", r#"[{"mesh":0,"scale":[0,0,0]}]"#), 17);
    assert_eq!(count("flat.gltf", r#"[{"mesh":0,"scale":[1,0,1]},{"mesh":0}]"#), 34);
    assert_eq!(count("turn.gltf", r#"[{"mesh":0,"rotation":[0,0,0,0]}]"#), 17);
    let loop_of = |n: usize| {
        let nodes: Vec<String> = (0..n).map(|k| format!(r#"{{"children":[{}]}}"#, (k + 1) % n)).collect();
        gltf(&folder, "loop.gltf", &format!("[{}]", nodes.join(",")), BOX, "")
    };
    for n in [1, 2, 5000] {
        let path = loop_of(n);
        let error = render(&path).unwrap_err();
        assert_eq!(error, format!("{}: glTF: node 0 is its own ancestor or below one that is", path.display()));
    }
    let far = gltf(&folder, "far.gltf", r#"[{"mesh":0,"scale":[1e30,1,1]}]"#, BOX, "");
    assert!(is_one_line_that_names(&render(&far).unwrap_err(), "far.gltf"));
}

/// Counts that nothing backs take no memory: with 400 MB to live on, they are refused and do not end the program.
#[test]
#[cfg(unix)]
fn huge_counts_take_no_memory() {
    let folder = Folder::new("counts").unwrap();
    write_companions(&folder.0).unwrap();
    let header = |vertices: &str, faces: &str| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
             property float z\nelement face {faces}\nproperty list uint int vertex_indices\nend_header\n"
        )
    };
    let with = |text: String, body: &[u8]| [text.as_bytes(), body].concat();
    let vertex = [0u8; 12];
    let list = |n: u32| [&vertex[..], &n.to_le_bytes()].concat();
    let path = gltf(&folder, "count.gltf", r#"[{"mesh":0}]"#, BOX, "");
    let text = std::fs::read_to_string(path).unwrap();
    let sparse =
        text.replace(r#""bufferView":0,"componentType":5126,"count":17"#, r#""componentType":5126,"count":4000000000"#);
    let files: [(&str, Vec<u8>, &str); 7] = [
        ("vertices.ply", with(header("4000000000", "1"), &vertex), "declares 4000000000 rows of at least 12 bytes"),
        ("faces.ply", with(header("1", "4000000000"), &vertex), "declares 4000000000 rows of at least 4 bytes"),
        ("list.ply", with(header("1", "1"), &list(u32::MAX)), "face 0: the file ends in it"),
        (
            "empty.ply",
            with(header("1", "1").replace("element face", "element vertex 0\nelement face"), &list(0)),
            "has no scalar property 'x'",
        ),
        ("count.gltf", text.replace("\"count\":17", "\"count\":4000000000").into_bytes(), "needs 48000000000 bytes"),
        ("sparse.gltf", sparse.into_bytes(), "4000000000 elements and no data"),
        (
            "chunk.glb",
            [b"glTF\x02\0\0\0\xff\xff\xff\xff".to_vec(), vec![0xff; 40]].concat(),
            "declared length 4294967295",
        ),
    ];
    for (name, bytes, part) in files {
        let path = folder.0.join(name);
        std::fs::write(&path, bytes).unwrap();
        let script =
            "ulimit -v 400000; exec \"$0\" render \"$1\" --engine cpu --size 8x6 --map 8 --quiet --out \"$1.out\"";
        let arguments = ["-c", script, env!("CARGO_BIN_EXE_subpixel-shadows"), path.to_str().unwrap()];
        let done = Command::new("sh").args(arguments).output().expect("a shell");
        let line = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(1), "{name}: {:?} {line}", done.status);
        assert!(line.contains(name) && line.contains(part) && line.lines().count() == 1, "{name}: {line}");
    }
}

/// Ends of the ranges of options, on the GPU: a whole picture of shares, or one line. All options and methods:
/// `cargo run --release --example hostile`.
#[gpu_test]
fn ends_of_ranges_on_the_gpu() {
    let folder = Folder::new("ends").unwrap();
    let out = folder.0.join("out");
    let cases: [(&str, Option<&str>); 12] = [
        ("--size 1x1 --map 1 --samples 1", None),
        ("--size 1x1 --map 1 --samples 128 --facets one", None),
        ("--size 3x65 --map 255", None),
        ("--size 24x18 --map 3 --force-all --memory-limit 1 --list-start 0", None),
        ("--size 24x18 --map 16 --memory-limit 18446744073709551615", None),
        ("--size 24x18 --map 16 --camera fov=1e-45", None),
        ("--size 24x18 --map 16 --camera fov=179.9999", None),
        ("--size 24x18 --map 16 --light directional=0,1e-45,0", None),
        ("--size 24x18 --map 16 --light point=1e38,1e38,1e38", None),
        ("--size 24x18 --map 16 --light spot=1,3,1;target=1,3,1.0000001;angle=1e-45", None),
        ("--size 24x18 --map 16 --camera eye=1e38,1e38,1e38", Some("far inf")),
        ("--size 24x18 --map 16 --list-start 18446744073709551615", Some("bytes, ")),
    ];
    for (options, refused) in cases {
        let _ = std::fs::remove_dir_all(&out);
        let mut words =
            vec!["render", "plane", "--engine", "gpu", "--quiet", "--frames", "1", "--out", out.to_str().unwrap()];
        words.extend(options.split(' '));
        if !options.contains("--samples") {
            words.extend(["--samples", "8"]);
        }
        let done = program(&words);
        let text = String::from_utf8_lossy(&done.stderr).into_owned();
        let own: Vec<&str> = text.lines().filter(|l| l.starts_with("subpixel-shadows: ")).collect();
        assert!(!text.contains("panicked"), "{options}: {text}");
        match refused {
            None => {
                assert!(done.status.success() && own.is_empty(), "{options}: {:?} {text}", done.status);
                let picture = image::open(out.join("visibility.exr")).unwrap().into_rgba32f();
                assert!(picture.pixels().all(|p| (0.0..=1.0).contains(&p[0])), "{options}");
            }
            Some(part) => {
                assert_eq!(done.status.code(), Some(1), "{options}: {text}");
                assert!(own.len() == 1 && own[0].contains(part), "{options}: {text}");
                assert!(!out.exists(), "{options}");
            }
        }
    }
}
