//! Files that are wrong in one way each, and files damaged at random.

use super::OBJ;
use super::files::{Folder, GltfText, glb, ply_binary, ply_text, tetrahedron_bin};
use lab::scene::{Scene, SceneOptions, load};

/// The file must be refused with one line that names it and holds `part`.
fn assert_refused(folder: &Folder, name: &str, bytes: &[u8], part: &str) {
    let path = folder.file(name, bytes);
    let Err(error) = load(&path) else { panic!("{name} was read; '{part}' was expected") };
    let message = error.to_string();
    assert!(message.contains(name) && message.contains(part), "{name}: '{part}' is not in: {message}");
    assert!(!message.contains(char::is_control) && message.len() < 1000, "{message}");
}

#[test]
fn bad_obj_files_are_refused() {
    let folder = Folder::new("obj");
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (name, text, part) in [
        ("nan.obj", "v nan 0 0\n", "vertex 0: 'nan' is NaN"),
        ("inf.obj", "v 0 0 0\nv 1 -inf 0\n", "line 2: vertex 1: '-inf' is -inf"),
        ("large.obj", "v 1e999 0 0\n", "'1e999' is inf"),
        ("word.obj", "v 0 zero 0\n", "'zero' is not a number"),
        ("short.obj", "v 0 1\n", "vertex 0 has 2 coordinates"),
        ("range.obj", &format!("{vertices}f 1 2 999999\n"), "line 4: face uses vertex 999999, the file has 3"),
        ("zero.obj", &format!("{vertices}f 0 1 2\n"), "line 4: face uses vertex 0"),
        ("before.obj", &format!("{vertices}f -9 1 2\n"), "uses vertex -9, 3 are declared"),
        ("big.obj", &format!("{vertices}f 1 2 99999999999999999999\n"), "'99999999999999999999' is not a whole number"),
        ("u32.obj", &format!("{vertices}f 1 2 4294967297\n"), "4294967297"),
        ("two.obj", &format!("{vertices}f 1 2\n"), "face has 2 corners"),
        ("index.obj", &format!("{vertices}f 1 2 x/1\n"), "'x' is not a whole number"),
        ("prose.obj", "Dear reader,\nthis is no mesh.\n", "line 1: 'Dear' is not an OBJ statement"),
        ("escape.obj", "\x1b[31mred\n", "is not an OBJ statement"),
        ("backslash.obj", "v 0 0 0\\", "line 1: the file ends after a backslash"),
    ] {
        assert_refused(&folder, name, text.as_bytes(), part);
    }
}

#[test]
fn files_that_are_something_else_are_refused() {
    let folder = Folder::new("mislabelled");
    let utf16: Vec<u8> = std::iter::once(0xfeffu16).chain(OBJ.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    for extension in ["obj", "ply", "gltf", "glb", "toml"] {
        let name = |what: &str| format!("{what}.{extension}");
        assert_refused(&folder, &name("empty"), b"", "0 bytes");
        assert_refused(&folder, &name("png"), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "PNG");
        assert_refused(&folder, &name("zip"), b"PK\x03\x04\x14\0\0\0", "ZIP");
        assert_refused(&folder, &name("utf16"), &utf16, "UTF-16");
        if extension != "ply" {
            assert_refused(&folder, &name("ply"), ply_text().as_bytes(), "PLY");
        }
        if !extension.starts_with("gl") {
            assert_refused(&folder, &name("glb"), &glb("{}", b""), "binary glTF");
        }
        if extension != "obj" {
            assert!(load(&folder.file(&name("obj"), OBJ.as_bytes())).is_err());
        }
        assert!(load(&folder.file(&name("zeros"), &[0; 64])).is_err());
        assert!(load(&folder.file(&name("ones"), &[0xff; 64])).is_err());
    }
    assert_refused(&folder, "mesh.stl", b"solid", "no extension that is read: glb, gltf, obj, ply, toml");
    let message = load(std::path::Path::new("/no/such/folder/mesh.ply")).unwrap_err().to_string();
    assert!(message.contains("mesh.ply"), "{message}");
    let directory = folder.file("x", b"").with_file_name("folder.ply");
    std::fs::create_dir(&directory).unwrap();
    assert!(load(&directory).unwrap_err().to_string().contains("not a file"));
}

#[test]
fn bad_ply_files_are_refused() {
    let folder = Folder::new("ply");
    let change = |from: &str, to: &str| {
        assert!(ply_text().contains(from), "{from}");
        ply_text().replacen(from, to, 1)
    };
    for (name, text, part) in [
        ("vertices.ply", change("vertex 4", "vertex 4000000000"), "declares 4000000000 rows"),
        ("wrap.ply", change("vertex 4", "vertex 18446744073709551615"), "declares 18446744073709551615 rows"),
        ("faces.ply", change("face 4", "face 4000000000"), "'face' declares 4000000000 rows"),
        ("minus.ply", change("vertex 4", "vertex -4"), "line 4: element 'vertex' has count '-4'"),
        ("more.ply", change("face 4", "face 5"), "face 4: the file ends"),
        ("nan.ply", change("0 0 1\n", "0 nan 1\n"), "vertex 3 (0, NaN, 1) is not finite"),
        ("large.ply", change("0 0 1\n", "0 1e60 1\n"), "vertex 3 (0, inf, 1) is not finite"),
        ("word.ply", change("0 0 1\n", "0 zero 1\n"), "vertex 3: 'zero' is not a number"),
        ("row.ply", change("0 0 1\n", "0 1\n"), "vertex 3: its line ends too early"),
        ("range.ply", change("3 0 2 1", "3 0 2 77"), "triangle 0 uses vertex 77, the file has 4"),
        ("negative.ply", change("3 0 2 1", "3 0 2 -1"), "face 0: uses vertex -1"),
        ("fraction.ply", change("3 0 2 1", "3 0 2 0.5"), "0.5 is not a vertex index"),
        ("two.ply", change("3 0 2 1", "2 0 2 1"), "face 0: has 2 corners"),
        ("length.ply", change("3 0 2 1", "-3 0 2 1"), "'vertex_indices' has length -3"),
        ("list.ply", change("3 1 2 3", "4000000000 1 2 3"), "face 3"),
        ("axis.ply", change("float y", "float w"), "no scalar property 'y'"),
        ("indices.ply", change("vertex_indices", "corners"), "no list property 'vertex_indices'"),
        ("type.ply", change("float y", "half y"), "line 6: 'property half y'"),
        ("format.ply", change("ascii 1.0", "text 1.0"), "format 'text'"),
        ("noformat.ply", change("format ascii 1.0\n", ""), "no line 'format'"),
        ("noend.ply", change("end_header\n", ""), "'0 0 0' is not a line"),
        ("property.ply", change("comment made here", "property float x"), "line 3"),
        ("novertex.ply", change("element vertex 4", "element point 4"), "no element 'vertex'"),
        ("start.ply", change("ply\n", "plyx\n"), "does not start with a line 'ply'"),
    ] {
        assert_refused(&folder, name, text.as_bytes(), part);
    }
    let binary = ply_binary(false);
    assert_refused(&folder, "cut.ply", &binary[..binary.len() - 30], "face 2: the file ends in it, 153 bytes");
}

#[test]
fn bad_glb_containers_are_refused() {
    let folder = Folder::new("glb");
    let good = glb(&GltfText::default().without_uri().render(), &tetrahedron_bin());
    let changed = |at: usize, value: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    for length in 0..12 {
        assert_refused(&folder, "length.glb", &changed(8, length), &format!("declared length {length},"));
    }
    assert_refused(&folder, "twelve.glb", &changed(8, 12), "no JSON chunk");
    assert_refused(&folder, "long.glb", &changed(8, u32::MAX), "declared length 4294967295");
    assert_refused(&folder, "chunk.glb", &changed(12, u32::MAX), "chunk at byte 12 declares 4294967295 bytes");
    assert_refused(&folder, "version.glb", &changed(4, 1), "version 1");
    assert_refused(&folder, "four.glb", b"glTF", "ends at byte 4");
    let json = GltfText::default().without_uri().render();
    assert_refused(&folder, "nobin.glb", &glb(&json, b""), "buffer 0 declares 72 bytes, has 0");
}

#[test]
fn bad_gltf_documents_are_refused() {
    let folder = Folder::new("gltf");
    folder.file("t.bin", &tetrahedron_bin());
    let good = GltfText::default;
    let views = |first: &str| format!(r#"[{{"buffer":0,{first}}},{{"buffer":0,"byteOffset":48,"byteLength":24}}]"#);
    let accessors = |first: &str, second: &str| {
        format!(
            r#"[{{"bufferView":0,"componentType":5126,"type":"VEC3",{first}}},
            {{"bufferView":1,"type":"SCALAR",{second}}}]"#
        )
    };
    let indices = r#""componentType":5123,"count":12"#;
    let sparse = |count: u32, at: u32| {
        format!(
            r#"[{{"componentType":5126,"type":"VEC3","count":4,"sparse":{{"count":{count},
            "indices":{{"bufferView":1,"byteOffset":{at},"componentType":5123}},"values":{{"bufferView":0}}}}}},
            {{"bufferView":1,"type":"SCALAR",{indices}}}]"#
        )
    };
    let uri = |uri: &str| GltfText { uri: format!(r#","uri":"{uri}""#), ..good() };
    let tree = |nodes: &str| GltfText { nodes: nodes.into(), ..good() };
    let with = |first: &str, second: &str| GltfText { accessors: accessors(first, second), ..good() };
    let cases = [
        ("version", GltfText { asset: r#"{"version":"1.0"}"#.into(), ..good() }, "version '1.0'"),
        ("buffer", GltfText { bytes: 73, ..good() }, "buffer 0 declares 73 bytes, has 72"),
        ("outside", uri("../t.bin"), "'../t.bin' is not a relative path"),
        ("hidden", uri("%2e%2e/t.bin"), "'../t.bin' is not a relative path"),
        ("absolute", uri("/etc/passwd"), "'/etc/passwd' is not a relative path"),
        ("http", uri("http://example.org/t.bin"), "'http://example.org/t.bin'"),
        ("file", uri("file:///etc/passwd"), "'file:///etc/passwd'"),
        ("missing", uri("none.bin"), "none.bin"),
        ("percent", uri("t%2"), "two hex digits"),
        ("data", uri("data:text/plain,abc"), "not base64"),
        ("base64", uri("data:;base64,AA!A"), "byte 33 at place 2"),
        (
            "view",
            GltfText { views: views(r#""byteLength":480"#), ..good() },
            "view 0 takes 480 bytes from 0, buffer 0 has 72",
        ),
        (
            "offset",
            GltfText { views: views(r#""byteOffset":18446744073709551615,"byteLength":48"#), ..good() },
            "18446744073709551615",
        ),
        ("stride", GltfText { views: views(r#""byteLength":48,"byteStride":4"#), ..good() }, "view 0 has stride 4"),
        (
            "strides",
            GltfText { views: views(r#""byteLength":48,"byteStride":16"#), ..good() },
            "accessor 0 needs 60 bytes, view 0 has 48",
        ),
        (
            "wrap",
            GltfText { views: views(r#""byteLength":48,"byteStride":9223372036854775808"#), ..good() },
            "stride 9223372036854775808",
        ),
        (
            "which",
            GltfText {
                views: views(r#""byteLength":48"#).replace("\"buffer\":0,\"byteL", "\"buffer\":3,\"byteL"),
                ..good()
            },
            "buffer 3",
        ),
        ("count", with(r#""count":100"#, indices), "accessor 0 needs 1200 bytes, view 0 has 48"),
        ("counts", with(r#""count":2147483648"#, indices), "25769803776 bytes"),
        ("countmax", with(r#""count":18446744073709551615"#, indices), "18446744073709551615"),
        ("many", with(r#""count":4"#, r#""componentType":5123,"count":4000000000"#), "1333333333 triangles"),
        ("accessoroffset", with(r#""count":4,"byteOffset":4"#, indices), "needs 52 bytes"),
        ("range", with(r#""count":3"#, indices), "mesh 'chair': triangle 1 uses vertex 3, the mesh has 3"),
        ("floats", with(r#""count":4"#, r#""componentType":5126,"count":6"#), "component type 5126"),
        ("unknown", with(r#""count":4"#, r#""componentType":99,"count":6"#), "component type 99"),
        ("sparse", GltfText { accessors: sparse(5, 0), ..good() }, "has 4 elements and 5 sparse ones"),
        ("sparseend", GltfText { accessors: sparse(4, 18), ..good() }, "needs 26 bytes, view 1 has 24"),
        (
            "nodata",
            GltfText { accessors: sparse(0, 0).replace("\"count\":4", "\"count\":2000000"), ..good() },
            "2000000 elements and no data",
        ),
        (
            "scalar",
            GltfText { accessors: good().accessors.replace("VEC3", "VEC2"), ..good() },
            "accessor 0 of positions is not VEC3",
        ),
        ("mode", GltfText { primitive: r#"{"attributes":{"POSITION":0},"mode":9}"#.into(), ..good() }, "mode 9"),
        (
            "position",
            GltfText { primitive: r#"{"attributes":{"POSITION":7}}"#.into(), ..good() },
            "accessor 7 is used, there are 2",
        ),
        ("mesh", tree(r#"[{"mesh":5}]"#), "mesh 5 is used, there are 1"),
        ("child", tree(r#"[{"children":[8]}]"#), "node 0 has child 8, there are 1"),
        ("self", tree(r#"[{"children":[0]}]"#), "node 0 is its own ancestor"),
        ("cycle", tree(r#"[{},{"children":[2]},{"children":[1]}]"#), "node 1 is its own ancestor"),
        ("parents", tree(r#"[{"children":[1,2]},{"children":[2]},{}]"#), "node 2 has two parents, 0 and 1"),
        (
            "rootchild",
            GltfText { scene: r#""scenes":[{"nodes":[0,1]}]"#.into(), ..tree(r#"[{"children":[1]},{"mesh":0}]"#) },
            "node 1 is in the scene twice",
        ),
        ("root", GltfText { scene: r#""scenes":[{"nodes":[4]}]"#.into(), ..good() }, "root node 4"),
        ("scene", GltfText { scene: r#""scene":2"#.into(), ..good() }, "scene 2 is used, there are 0"),
        ("matrix", tree(r#"[{"mesh":0,"matrix":[1,2]}]"#), "line"),
        ("overflow", tree(r#"[{"mesh":0,"scale":[1e300,1,1]}]"#), "vertex"),
        ("camera", tree(r#"[{"camera":1}]"#), "camera 1 is used, there are 0"),
        (
            "fov",
            GltfText { extra: r#","cameras":[{"perspective":{"yfov":4}}]"#.into(), ..tree(r#"[{"camera":0}]"#) },
            "229.1",
        ),
        (
            "flat",
            GltfText {
                extra: r#","cameras":[{"perspective":{"yfov":1}}]"#.into(),
                ..tree(r#"[{"camera":0,"scale":[0,0,0]}]"#)
            },
            "node 0: camera 0",
        ),
        ("light", tree(r#"[{"extensions":{"KHR_lights_punctual":{"light":2}}}]"#), "light 2 is used, there are 0"),
        (
            "lightkind",
            GltfText {
                extra: r#","extensions":{"KHR_lights_punctual":{"lights":[{"type":"sun"}]}}"#.into(),
                ..tree(r#"[{"extensions":{"KHR_lights_punctual":{"light":0}}}]"#)
            },
            "type 'sun'",
        ),
        (
            "draco",
            GltfText { extra: r#","extensionsRequired":["KHR_draco_mesh_compression"]"#.into(), ..good() },
            "'KHR_draco_mesh_compression'",
        ),
        ("twice", GltfText { extra: r#","nodes":[]"#.into(), ..good() }, "duplicate field"),
    ];
    for (name, text, part) in cases {
        assert_refused(&folder, &format!("{name}.gltf"), text.render().as_bytes(), part);
    }
    let sparse_index = {
        // The index buffer starts 0, 2, 1, 0: an element 2 of 2.
        let text =
            GltfText { accessors: sparse(2, 0).replace("\"VEC3\",\"count\":4", "\"VEC3\",\"count\":2"), ..good() };
        text.render()
    };
    assert_refused(&folder, "sparseindex.gltf", sparse_index.as_bytes(), "sparse value for element 2, has 2 elements");
    let nan = [&f32::NAN.to_le_bytes(), &tetrahedron_bin()[4..]].concat();
    folder.file("t.bin", &nan);
    assert_refused(&folder, "nan.gltf", good().render().as_bytes(), "mesh 'chair': vertex 0 (NaN, 0, 0) is not finite");
    assert_refused(&folder, "deep.gltf", ["{\"x\":", &"[".repeat(100_000)].concat().as_bytes(), "line 1 column 100005");
}

#[test]
fn gltf_trees_may_be_deep_but_not_multiply_without_end() {
    let folder = Folder::new("tree");
    folder.file("t.bin", &tetrahedron_bin());
    let deep = 200_000;
    let mut nodes: Vec<String> = (1..deep).map(|k| format!(r#"{{"children":[{k}]}}"#)).collect();
    nodes.push(r#"{"mesh":0}"#.into());
    let text = GltfText { nodes: format!("[{}]", nodes.join(",")), ..GltfText::default() };
    assert_eq!(load(&folder.file("deep.gltf", text.render().as_bytes())).unwrap().mesh.triangles.len(), 4);

    let primitive = vec![r#"{"attributes":{"POSITION":0},"indices":1}"#; 20_000].join(",");
    let nodes = format!("[{{\"children\":[{}]}}{}]", numbers(1..4_001), ",{\"mesh\":0}".repeat(4_000));
    let text = GltfText { primitive, nodes, ..GltfText::default() };
    assert_refused(&folder, "many.gltf", text.render().as_bytes(), "at most 134217728 may be used");
}

fn numbers(range: std::ops::Range<u32>) -> String {
    range.map(|n| n.to_string()).collect::<Vec<_>>().join(",")
}

#[test]
fn bad_scene_files_are_refused() {
    let folder = Folder::new("toml");
    folder.file("t.obj", OBJ.as_bytes());
    folder.file("bad.obj", b"f 1 2 3\n");
    for (name, text, part) in [
        ("none.toml", "ground = true\n", "exactly one of the keys 'mesh' and 'builtin'"),
        ("both.toml", "mesh = \"t.obj\"\nbuiltin = \"plane\"\n", "exactly one"),
        ("unknown.toml", "mesh = \"t.obj\"\ncolour = 3\n", "line 2: unknown field `colour`"),
        ("key.toml", "mesh = \"t.obj\"\n[camera]\nzoom = 3\n", "unknown field `zoom`"),
        ("syntax.toml", "mesh = \"t.obj\"\n[camera\n", "line 2"),
        ("type.toml", "mesh = 7\n", "line 1"),
        ("outside.toml", "mesh = \"../t.obj\"\n", "'../t.obj' is not a relative path"),
        ("middle.toml", "mesh = \"a/../../t.obj\"\n", "is not a relative path"),
        ("absolute.toml", "mesh = \"/t.obj\"\n", "'/t.obj' is not a relative path"),
        ("windows.toml", "mesh = \"C:\\\\t.obj\"\n", "is not a relative path"),
        ("missing.toml", "mesh = \"none.obj\"\n", "none.obj"),
        ("badmesh.toml", "mesh = \"bad.obj\"\n", "line 1: face uses vertex 3, the file has 0"),
        ("nested.toml", "mesh = \"nested.toml\"\n", "is a scene file itself"),
        ("builtin.toml", "builtin = \"castle\"\n", "'castle' is none of windmill"),
        ("fov.toml", "mesh = \"t.obj\"\n[camera]\nfov = 180.0\n", "180 degrees"),
        ("eye.toml", "mesh = \"t.obj\"\n[camera]\neye = [0.0, 1.0]\n", "line 3"),
        ("nan.toml", "mesh = \"t.obj\"\n[camera]\neye = [nan, 0.0, 0.0]\n", "(NaN, 0, 0) is not finite"),
        ("nolight.toml", "mesh = \"t.obj\"\n[light]\n", "exactly one of 'directional', 'point' and 'spot'"),
        ("lights.toml", "mesh = \"t.obj\"\n[light]\npoint = [0.0,0.0,0.0]\nspot = [0.0,0.0,0.0]\n", "exactly one of"),
        ("zero.toml", "mesh = \"t.obj\"\n[light]\ndirectional = [0.0,0.0,0.0]\n", "length 0"),
        ("angle.toml", "mesh = \"t.obj\"\n[light]\npoint = [1.0,0.0,0.0]\nangle = 5.0\n", "angle"),
    ] {
        assert_refused(&folder, name, text.as_bytes(), part);
    }
    assert_refused(&folder, "latin.toml", b"mesh = \"t\xe9.obj\"\n", "not UTF-8 at byte 9");
}

/// Numbers that look random and are the same every time.
fn next(state: &mut u64) -> usize {
    *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*state >> 33) as usize
}

/// Damaged files may still be readable, but give a mesh that passes its checks or one line that names the file.
#[test]
fn damaged_files_never_panic() {
    let folder = Folder::new("damaged");
    folder.file("t.bin", &tetrahedron_bin());
    folder.file("t.obj", OBJ.as_bytes());
    let gltf = GltfText {
        nodes: r#"[{"mesh":0,"children":[1]},{"camera":0,"rotation":[0,1,0,0]}]"#.into(),
        extra: r#","cameras":[{"type":"perspective","perspective":{"yfov":0.5}}]"#.into(),
        ..GltfText::default()
    };
    let toml = "mesh = \"t.obj\"\nground = true\n[camera]\neye = [1.0, 2.0, 3.0]\nfov = 40.0\n[light]\npoint = [1.0, 5.0, 0.0]\n";
    let seeds: [(&str, Vec<u8>); 8] = [
        ("d.obj", OBJ.into()),
        ("text.ply", ply_text().into()),
        ("little.ply", ply_binary(false)),
        ("big.ply", ply_binary(true)),
        ("d.gltf", gltf.render().into()),
        ("data.gltf", gltf.clone().with_data_uri().render().into()),
        ("d.glb", glb(&gltf.without_uri().render(), &tetrahedron_bin())),
        ("d.toml", toml.into()),
    ];
    let mut state = 1;
    for (name, seed) in seeds {
        let check = |bytes: &[u8]| {
            let path = folder.file(name, bytes);
            match Scene::open(path.to_str().unwrap(), &SceneOptions { ground: true, ..SceneOptions::default() }) {
                Ok(scene) => scene.mesh.check(name).unwrap(),
                Err(e) => {
                    let message = e.to_string();
                    assert!(!message.contains('\n') && message.len() < 1000, "{message}");
                }
            }
        };
        check(&seed);
        (0..seed.len()).for_each(|length| check(&seed[..length]));
        for _ in 0..1500 {
            let mut bytes = seed.clone();
            for _ in 0..1 + next(&mut state) % 4 {
                let at = next(&mut state) % bytes.len();
                match next(&mut state) % 5 {
                    0 => bytes[at] ^= 1 << (next(&mut state) % 8),
                    1 => bytes[at] = next(&mut state) as u8,
                    2 => bytes[at] = b"0123456789-.e,[]{}\n \\\"\xff\x7f\x80"[next(&mut state) % 25],
                    3 => drop(bytes.remove(at)),
                    _ => bytes.insert(at, b"9-e\n,"[next(&mut state) % 5]),
                }
            }
            check(&bytes);
        }
    }
}
