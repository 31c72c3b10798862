//! Loaders and scenes, on files made here.

#[path = "scene/alpha.rs"]
mod alpha;
#[path = "scene/faults.rs"]
mod faults;
#[path = "scene/files.rs"]
mod files;

use files::{Folder, GltfText, glb, ply_binary, ply_text, tetrahedron_bin};
use lab::scene::{Scene, SceneOptions, light_from_text, load};
use std::path::Path;
use subpixel_shadows::Error;
use subpixel_shadows::scene::{Adjacency, Light};

const OBJ: &str = "# tetrahedron\no t\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// The four triangles of the tetrahedron, however they came in.
fn assert_tetrahedron(path: &Path) {
    let mesh = load(path).unwrap_or_else(|e| panic!("{e}")).mesh;
    let folder = Folder::new("expected");
    let expected = load(&folder.file("t.obj", OBJ.as_bytes())).unwrap().mesh;
    assert_eq!(mesh.canonical().0, expected.canonical().0, "{}", path.display());
    assert!(Adjacency::of(&mesh).closed, "{}", path.display());
}

#[test]
fn every_format_gives_the_same_mesh() {
    let folder = Folder::new("formats");
    assert_tetrahedron(&folder.file("t.obj", OBJ.as_bytes()));
    assert_tetrahedron(&folder.file("crlf.OBJ", OBJ.replace('\n', "\r\n").as_bytes()));
    assert_tetrahedron(&folder.file("bom.obj", format!("\u{feff}{OBJ}").as_bytes()));
    assert_tetrahedron(&folder.file("noeol.obj", OBJ.trim_end().as_bytes()));
    assert_tetrahedron(&folder.file(
        "negative.obj",
        b"v 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nv 0 0 1\nvt 0 0\nvn 0 0 1\nf -4/1/1 -2/1/1 -3/1/1\nf -4//1 -3//1 \\\n -1//1\nf 1/1 4/1 3/1\nf 2 3 4 # done\n",
    ));
    assert_tetrahedron(&folder.file("latin.obj", &[b"# caf\xe9\ng caf\xe9\n", OBJ.as_bytes()].concat()));
    assert_tetrahedron(&folder.file("t.ply", ply_text().as_bytes()));
    assert_tetrahedron(&folder.file("crlf.ply", ply_text().replace('\n', "\r\n").as_bytes()));
    assert_tetrahedron(&folder.file("le.ply", &ply_binary(false)));
    assert_tetrahedron(&folder.file("be.ply", &ply_binary(true)));
    let text = GltfText::default();
    folder.file("t.bin", &tetrahedron_bin());
    assert_tetrahedron(&folder.file("t.gltf", text.render().as_bytes()));
    assert_tetrahedron(&folder.file("data.gltf", text.clone().with_data_uri().render().as_bytes()));
    assert_tetrahedron(&folder.file("t.glb", &glb(&text.without_uri().render(), &tetrahedron_bin())));
    folder.file("a b.bin", &tetrahedron_bin());
    let escaped = GltfText { uri: r#","uri":"./a%20b.bin""#.into(), ..GltfText::default() };
    assert_tetrahedron(&folder.file("escaped.gltf", escaped.render().as_bytes()));
    assert_tetrahedron(&folder.file("scene.toml", b"mesh = \"t.ply\"\n"));
}

#[test]
fn polygons_strips_and_extra_elements_are_read() {
    let folder = Folder::new("polygons");
    let quad = load(&folder.file("q.obj", b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 .5 0\nf 1 2 3 4 5\n")).unwrap();
    assert_eq!(quad.mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    let strips = "ply\nformat ascii 1.0\nelement vertex 5\nproperty double z\nproperty short y\nproperty uchar x\nelement note 0\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n0 0 1\n0 1 0\n0 1 1\n0 2 0\n9 0 1 2 3 -1 2 3 4 -1\n";
    let mesh = load(&folder.file("s.ply", strips.as_bytes())).unwrap().mesh;
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    assert_eq!(mesh.positions[1], [1.0, 0.0, 0.0]);
}

#[test]
fn gltf_nodes_place_what_they_hold() {
    let folder = Folder::new("nodes");
    folder.file("t.bin", &tetrahedron_bin());
    let text = GltfText {
        nodes: r#"[{"children":[1,2,3],"scale":[-2,2,2],"translation":[10,0,0]},{"mesh":0,"translation":[0,1,0]},
            {"camera":0,"rotation":[0,1,0,0]},{"extensions":{"KHR_lights_punctual":{"light":0}}}]"#
            .into(),
        extra: r#","cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}}],
            "extensions":{"KHR_lights_punctual":{"lights":[{"type":"directional"}]}},
            "extensionsRequired":["KHR_lights_punctual"]"#
            .into(),
        ..GltfText::default()
    };
    let loaded = load(&folder.file("t.gltf", text.render().as_bytes())).unwrap();
    assert_eq!(loaded.mesh.bounds().unwrap(), ([8.0, 2.0, 0.0].into(), [10.0, 4.0, 2.0].into()));
    assert!(Adjacency::of(&loaded.mesh).closed, "a mirrored mesh keeps its outside");
    let camera = loaded.camera.unwrap();
    assert_eq!(camera.eye, [10.0, 0.0, 0.0]);
    assert!((camera.vertical_fov_degrees - 0.5f32.to_degrees()).abs() < 1e-4);
    assert!(camera.target[2] > camera.eye[2], "half a turn about y looks along +z");
    let Some(Light::Directional { direction }) = loaded.light else { panic!("{:?}", loaded.light) };
    assert_eq!(direction.map(f32::signum)[2], 1.0);
}

#[test]
fn sparse_and_quantised_accessors_are_read() {
    let folder = Folder::new("accessors");
    // Four normalised i8 positions at stride 4, one of them replaced, and u8 indices.
    let bytes: Vec<i8> = vec![0, 0, 0, 9, 127, 0, 0, 9, 0, -128, 0, 9, 0, 0, 9, 9, 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
    let mut bytes: Vec<u8> = bytes.iter().map(|b| *b as u8).collect();
    bytes.extend([3, 0, 0, 0, 0, 0, 127]);
    folder.file("t.bin", &bytes);
    let text = GltfText {
        bytes: bytes.len(),
        views: r#"[{"buffer":0,"byteLength":16,"byteStride":4},{"buffer":0,"byteOffset":16,"byteLength":12},
            {"buffer":0,"byteOffset":28,"byteLength":1},{"buffer":0,"byteOffset":32,"byteLength":3}]"#
            .into(),
        accessors: r#"[{"bufferView":0,"componentType":5120,"normalized":true,"count":4,"type":"VEC3","sparse":
            {"count":1,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}}},
            {"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}]"#
            .into(),
        ..GltfText::default()
    };
    let mesh = load(&folder.file("t.gltf", text.render().as_bytes())).unwrap().mesh;
    assert_eq!(mesh.canonical().0.positions, [[0.0, -1.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
    assert_eq!(mesh.triangles.len(), 4);
}

#[test]
fn scene_files_set_camera_light_and_ground() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    let gate = Scene::open(data.join("gate.toml").to_str().unwrap(), &SceneOptions::default()).unwrap();
    assert_eq!(gate.mesh.triangles.len(), 156 + 2);
    assert_eq!(gate.camera.eye, [3.6, 3.2, 6.2]);
    assert!(matches!(gate.light, Light::Spot { .. }));
    assert_eq!(gate.ground.unwrap().y, 0.0);
    let evening = Scene::open(data.join("windmill-evening.toml").to_str().unwrap(), &SceneOptions::default()).unwrap();
    assert_eq!(evening.light, Light::Directional { direction: [-0.8, 0.42, 0.3] });
    assert_eq!(evening.ground, None);
    let roof = Scene::open(data.join("city-roof.toml").to_str().unwrap(), &SceneOptions::default()).unwrap();
    assert_eq!((roof.camera.eye, roof.camera.vertical_fov_degrees), ([0.0, 45.0, 110.0], 60.0));
}

#[test]
fn options_override_what_a_scene_brings() {
    let options = SceneOptions {
        ground: true,
        camera: Some("eye=5,6,7;fov=30".parse().unwrap()),
        light: Some(light_from_text("point=1,9,1").unwrap()),
    };
    let scene = Scene::open("plane", &options).unwrap();
    let own = Scene::open("plane", &SceneOptions::default()).unwrap();
    assert_eq!((scene.camera.eye, scene.camera.target), ([5.0, 6.0, 7.0], own.camera.target));
    assert_eq!(scene.camera.vertical_fov_degrees, 30.0);
    assert_eq!(scene.light, Light::Point { position: [1.0, 9.0, 1.0] });
    assert_eq!(scene.mesh.triangles.len(), own.mesh.triangles.len() + 2);
    assert!(scene.ground.is_some() && own.ground.is_none());
}

#[test]
fn a_scene_without_triangles_is_no_error() {
    let folder = Folder::new("empty");
    let path = folder.file("none.obj", b"# nothing\nv 1 2 3\n");
    let options = SceneOptions { ground: true, ..SceneOptions::default() };
    let scene = Scene::open(path.to_str().unwrap(), &options).unwrap();
    assert_eq!((scene.mesh.triangles.len(), scene.ground), (0, None));
    scene.camera.check().unwrap();
}

#[test]
fn what_is_no_scene_is_refused_in_one_line() {
    let message = Scene::open("wind", &SceneOptions::default()).unwrap_err().to_string();
    assert!(message.contains("'wind'") && message.contains("windmill, cage"), "{message}");
    let missing = Scene::open("no/such.obj", &SceneOptions::default()).unwrap_err();
    assert!(matches!(missing, Error::File { .. }) && missing.to_string().contains("such.obj"), "{missing}");
    let folder = Folder::new("huge");
    let path = folder.file("far.obj", b"v -3e38 0 0\nv 3e38 0 0\nv 0 1 0\nf 1 2 3\n");
    let message = Scene::open(path.to_str().unwrap(), &SceneOptions::default()).unwrap_err().to_string();
    assert!(message.contains("far.obj") && message.contains("too far"), "{message}");
    // Framed well enough, but the ground below would not be finite.
    let camera = Some("eye=0,0,9;target=0,0,0".parse().unwrap());
    let wide = folder.file("wide.obj", b"v -3e37 0 0\nv 3e37 0 0\nv 0 1 0\nf 1 2 3\n");
    let options = SceneOptions { ground: true, camera, light: None };
    assert!(Scene::open(wide.to_str().unwrap(), &options).is_err());
}
