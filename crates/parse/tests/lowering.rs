//! Lowering of scene text: what each construct becomes.

use radsight_ir::{BsdfForm, Material, ModifierHandle, ModifierKind, Pattern, Rgb, Scene, Shape, Substitute};
use radsight_loader::MemoryLoader;
use radsight_parse::{BrdfReplacement, Input, Read, ReadOptions, UnusedModifiers, read_scene};
use std::sync::Arc;

fn read_with(text: &str, loader: &MemoryLoader, options: &ReadOptions) -> Read {
    let read =
        read_scene(&[Input::Text { name: "scene.rad".to_owned(), text: text.as_bytes().into() }], loader, options);
    assert!(read.diagnostics.is_empty(), "{}", read.render(9));
    read
}

fn scene(text: &str) -> Scene {
    read_with(text, &MemoryLoader::default(), &ReadOptions::default()).scene
}

/// The material of the n-th surface.
fn material(scene: &Scene, surface: usize) -> &Material {
    let handle = scene.surfaces.items()[surface].modifier;
    let found = scene.chain(handle).find_map(|(_, modifier)| match &modifier.kind {
        ModifierKind::Material(material) => Some(material),
        _ => None,
    });
    found.expect("the surface has a material")
}

fn color(scene: &Scene, surface: usize) -> Rgb {
    match material(scene, surface) {
        Material::Plastic(surface) | Material::Metal(surface) => surface.color,
        other => panic!("{other:?}"),
    }
}

const BALL: &str = "sphere s 0 0 4 0 0 0 1\n";

#[test]
fn a_later_definition_counts_for_what_follows() {
    let text = format!("void plastic m 0 0 5 1 0 0 0 0 m {BALL} void plastic m 0 0 5 0 1 0 0 0 m {BALL}");
    let scene = scene(&text);
    assert_eq!((color(&scene, 0), color(&scene, 1)), (Rgb([1.0, 0.0, 0.0]), Rgb([0.0, 1.0, 0.0])));
}

#[test]
fn the_same_definition_again_is_the_first_one() {
    let loader = MemoryLoader::default().with("part", format!("void plastic m 0 0 5 1 0 0 0 0\nm {BALL}"));
    let scene = read_with("!xform -a 100 -t 1 0 0 part\n", &loader, &ReadOptions::default()).scene;
    assert_eq!((scene.surfaces.len(), scene.modifiers.len()), (100, 1));
}

#[test]
fn copies_of_a_function_share_their_program_and_differ_in_their_place() {
    let part = format!("void brightfunc f 2 Px . 0 0\nf plastic m 0 0 5 1 1 1 0 0\nm {BALL}");
    let loader = MemoryLoader::default().with("part", part);
    let scene = read_with("!xform -a 3 -t 1 0 0 part\n", &loader, &ReadOptions::default()).scene;
    let call = |modifier| match modifier {
        ModifierKind::Pattern(Pattern::BrightFunction(call)) => Some(call.clone()),
        _ => None,
    };
    let calls: Vec<_> = scene.modifiers.items().iter().filter_map(|modifier| call(modifier.kind.clone())).collect();
    let places: Vec<f64> = calls.iter().map(|call| call.to_scene.translation.x).collect();
    assert_eq!(places, [0.0, 1.0, 2.0]);
    assert!(Arc::ptr_eq(&calls[0].program, &calls[2].program));
}

#[test]
fn an_alias_is_its_target_under_its_own_modifier() {
    let text = format!(
        "void plastic red 0 0 5 1 0 0 0 0
         void brightfunc half 2 .5 . 0 0
         void alias same red
         inherit alias inherited red
         half alias patterned red
         same {BALL} inherited {BALL} patterned {BALL}"
    );
    let scene = scene(&text);
    let handles: Vec<Option<ModifierHandle>> = scene.surfaces.items().iter().map(|surface| surface.modifier).collect();
    let names = |surface: usize| (scene.modifier_name(handles[surface]), scene.original_name(handles[surface]));
    assert_eq!([0, 1, 2].map(names), [("same", "red"), ("inherited", "red"), ("patterned", "red")]);
    assert_eq!([0, 1, 2].map(|surface: usize| scene.chain(handles[surface]).count()), [1, 1, 2]);
    assert_eq!([0, 1, 2].map(|surface| color(&scene, surface)), [Rgb([1.0, 0.0, 0.0]); 3]);
}

#[test]
fn a_name_among_the_strings_means_what_it_meant_there() {
    let text = format!(
        "void glass pane 0 0 3 .5 .5 .5
         void illum seen 1 pane 0 3 1 1 1
         void illum through 1 void 0 3 1 1 1
         void illum own 0 0 3 1 1 1
         void plastic pane 0 0 5 1 1 1 0 0
         seen {BALL} through {BALL} own {BALL}"
    );
    let scene = scene(&text);
    let substitute = |surface| match material(&scene, surface) {
        Material::Illum { substitute, .. } => *substitute,
        other => panic!("{other:?}"),
    };
    let Substitute::Modifier(pane) = substitute(0) else { panic!() };
    assert!(matches!(scene.modifiers[pane].kind, ModifierKind::Material(Material::Glass { .. })));
    assert_eq!((substitute(1), substitute(2)), (Substitute::Void, Substitute::Own));
}

#[test]
fn only_what_is_used_is_loaded() {
    let text = format!("void brightdata unused 4 noop nosuch.dat . Px 0 0 void plastic red 0 0 5 1 0 0 0 0 red {BALL}");
    assert_eq!(scene(&text).modifiers.len(), 1);
    let input = Input::Text { name: "scene.rad".to_owned(), text: text.as_bytes().into() };
    let all = ReadOptions { unused: UnusedModifiers::Lower, ..ReadOptions::default() };
    let read = read_scene(&[input], &MemoryLoader::default(), &all);
    assert_eq!(read.diagnostics[0].message, "cannot find data file \"nosuch.dat\"");
}

#[test]
fn a_spotlight_has_its_angle_and_focal_distance() {
    let scene = scene("void spotlight s 0 0 7 1 2 3 60 0 0 -2\ns ring r 0 0 8 0 0 0 0 0 1 0 1\n");
    let Material::Spotlight { cone_angle, direction, focal_distance, .. } = material(&scene, 0) else { panic!() };
    assert!((cone_angle - std::f64::consts::FRAC_PI_3).abs() < 1e-15);
    assert_eq!((direction.to_array(), *focal_distance), ([0.0, 0.0, -1.0], 2.0));
}

#[test]
fn xform_turns_sizes_and_sides() {
    let part = "void glow g 0 0 4 1 1 1 5\nvoid dielectric d 0 0 5 .25 .25 .25 1.5 0\nvoid mist m 1 lamp 0 3 .1 .1 .1\n\
                g sphere s 0 0 4 1 0 0 1\nd polygon p 0 0 9 0 0 0 1 0 0 0 1 0\nm ring r 0 0 8 0 0 0 0 0 1 0 1\n";
    let loader = MemoryLoader::default().with("part", part);
    let scene = read_with("!xform -n a -I -s 2 -mx part\n", &loader, &ReadOptions::default()).scene;
    assert!(matches!(material(&scene, 0), Material::Glow { max_radius: 10.0, .. }));
    let Material::Dielectric(body) = material(&scene, 1) else { panic!() };
    assert_eq!(body.transmissivity, Rgb([0.5; 3]));
    let Material::Mist(mist) = material(&scene, 2) else { panic!() };
    assert_eq!((mist.extinction, &*mist.sources[0]), (Rgb([0.05; 3]), "a.lamp"));
    let sphere = &scene.spheres.items()[0];
    assert_eq!((sphere.center.x, sphere.radius, sphere.facing), (-2.0, 2.0, radsight_ir::Facing::Inward));
    // A mirror image and `-I` cancel each other for the order of vertices.
    assert_eq!(scene.vertices[1].to_array(), [-2.0, 0.0, 0.0]);
    assert_eq!(scene.rings.items()[0].normal.to_array(), [0.0, 0.0, -1.0]);
}

#[test]
fn a_polygon_loses_a_last_vertex_that_repeats_the_first() {
    let scene = scene("void polygon p 0 0 12 0 0 0 1 0 0 0 1 0 0 0 0\n");
    assert!(matches!(scene.surfaces.items()[0].shape, Shape::Polygon { count: 3, .. }));
}

#[test]
fn the_bands_of_a_table_may_have_functions_of_one_argument() {
    let text = "void colordata c 8 first second third t.dat t.dat t.dat f.cal 1 0 0\nc plastic m 0 0 5 1 1 1 0 0\n\
                m sphere s 0 0 4 0 0 0 1\n";
    let loader = MemoryLoader::default()
        .with("t.dat", "1 0 1 2 5 6\n")
        .with("f.cal", "first(r,g,b) = r; second(x) = 10*x; third(r,g,b) = r+g;");
    let scene = read_with(text, &loader, &ReadOptions::default()).scene;
    let ModifierKind::Pattern(Pattern::ColorData(data)) = &scene.modifiers.items()[0].kind else { panic!() };
    let mut scratch = radsight_cal::Scratch::new();
    let mut value = |root| data.call.program.eval(root, &[1.0, 2.0, 4.0], &radsight_cal::NoHost, &mut scratch).unwrap();
    assert_eq!([value(0), value(1), value(2)], [1.0, 20.0, 3.0]);
}

#[test]
fn a_material_is_replaced_by_a_plugin() {
    let text = format!(
        "#@radsight brdf sheet retrosheet bead_sheet .086 1.5
         void brightfunc half 2 .5 . 0 0
         half plastic sheet 0 0 5 1 1 1 0 0
         sheet {BALL} void brdfplugin other 3 lib model word 0 1 7 other {BALL} void metal asked 0 0 5 1 1 1 1 0 asked {BALL}"
    );
    let option = BrdfReplacement::parse("asked=lib:model(2)").unwrap();
    let options = ReadOptions { brdf: vec![option], ..ReadOptions::default() };
    let scene = read_with(&text, &MemoryLoader::default(), &options).scene;
    let plugin = |surface| match material(&scene, surface) {
        Material::Plugin { library, model, words, numbers, tokens } => {
            let tokens = tokens.iter().map(|span| &text[span.start as usize..span.end as usize]);
            format!("{library} {model} {words:?} {numbers:?} {:?}", tokens.collect::<Vec<_>>().join("|"))
        }
        other => panic!("{other:?}"),
    };
    assert_eq!(plugin(0), "retrosheet bead_sheet [] [0.086, 1.5] \"retrosheet|bead_sheet|.086|1.5\"");
    assert_eq!(plugin(1), "lib model [\"word\"] [7.0] \"lib|model|word|7\"");
    assert_eq!(plugin(2), "lib model [] [2.0] \"\"");
    assert_eq!(scene.chain(scene.surfaces.items()[0].modifier).count(), 2);
}

#[test]
fn commands_find_files_beside_the_file_they_stand_in() {
    let loader = MemoryLoader::default()
        .with("house/house.rad", "!xform -t 1 0 0 door.rad\n!cat door.rad\n")
        .with("house/door.rad", format!("void {BALL}"));
    let scene = read_with("!xform house/house.rad\n", &loader, &ReadOptions::default()).scene;
    let centers: Vec<f64> = scene.spheres.items().iter().map(|sphere| sphere.center.x).collect();
    assert_eq!(centers, [1.0, 0.0]);
}

#[test]
fn generated_text_goes_through_xform_in_its_place() {
    let text = "void plastic m 0 0 5 1 1 1 0 0\n!genbox m crate 1 1 1 | \\\n  xform -n b -s 2 | xform -n a -t 1 0 0\n";
    let scene = scene(text);
    assert_eq!(scene.surfaces.len(), 6);
    assert!(scene.names.get(scene.surfaces.items()[0].name).starts_with("a.b.crate."));
    let largest = scene.vertices.iter().map(|vertex| vertex.x).fold(f64::MIN, f64::max);
    assert_eq!(largest, 3.0);
}

#[test]
fn a_long_text_is_forgotten_but_not_where_its_lines_are() {
    let text = format!("# a comment\nvoid {BALL}");
    let options = ReadOptions { longest_kept_text: 10, ..ReadOptions::default() };
    let read = read_with(&text, &MemoryLoader::default(), &options);
    let span = read.scene.surfaces.items()[0].span.unwrap();
    assert!(read.sources.text(span.source).is_empty());
    assert_eq!(read.sources.position(span).line, 2);
}

/// A constant BSDF matrix that reflects a share of the light.
fn even_bsdf(share: f64) -> String {
    let data = format!("{:.6} ", share / std::f64::consts::PI).repeat(41 * 41);
    format!(
        "<WindowElement><FileType>BSDF</FileType><Optical><Layer>
<DataDefinition><IncidentDataStructure>Columns</IncidentDataStructure></DataDefinition>
<WavelengthData><Wavelength>Visible</Wavelength><WavelengthDataBlock>
<WavelengthDataDirection>Reflection Back</WavelengthDataDirection>
<ColumnAngleBasis>LBNL/Klems Quarter</ColumnAngleBasis><RowAngleBasis>LBNL/Klems Quarter</RowAngleBasis>
<ScatteringData>{data}</ScatteringData></WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>"
    )
}

#[test]
fn bsdf_materials_have_their_data_and_functions() {
    let loader = MemoryLoader::default().with("even.xml", even_bsdf(0.5));
    let text = format!(
        "void BSDF b 8 .1 even.xml 0 1 0 . -s 2 0 6 .1 .2 .3 .4 .5 .6 b {BALL}
         void aBSDF a 5 even.xml Nx Ny 1 . 0 0 a {BALL}"
    );
    let scene = read_with(&text, &loader, &ReadOptions::default()).scene;
    assert_eq!(scene.bsdfs.len(), 1);
    let Material::Bsdf { data, call, form, added_diffuse } = material(&scene, 0) else { panic!("a BSDF") };
    assert_eq!((*form, call.program.roots(), call.to_scene.scale), (BsdfForm::Proxy, 4, 2.0));
    assert_eq!(added_diffuse[1..], [Rgb([0.4, 0.5, 0.6]), Rgb::BLACK]);
    let reflectance = scene.bsdfs[*data].bsdf.diffuse_reflectance(radsight_measured::Side::Front);
    assert!((reflectance[0] - 0.5).abs() < 1e-5);
    let Material::Bsdf { call, form, .. } = material(&scene, 1) else { panic!("an aBSDF") };
    assert_eq!((*form, call.program.roots()), (BsdfForm::Aperture, 3));
}

#[test]
fn a_bsdf_that_is_wrong_is_shown_in_its_own_file() {
    let wrong = even_bsdf(0.5).replacen("0.159155", "x.159155", 2);
    let loader = MemoryLoader::default().with("wrong.xml", wrong).with("gain.xml", even_bsdf(1.2));
    let text = format!("void BSDF b 6 0 wrong.xml 0 1 0 . 0 0 b {BALL} void BSDF c 6 0 gain.xml 0 1 0 . 0 0 c {BALL}");
    let input = Input::Text { name: "scene.rad".to_owned(), text: text.as_bytes().into() };
    let read = read_scene(&[input], &loader, &ReadOptions::default());
    let messages = read.render(9);
    let mistake = "wrong.xml:6:17: warning: a scattering value is \"x.159155\", expected a finite number\n";
    assert!(messages.contains(mistake), "{messages}");
    assert!(messages.contains("warning: \"gain.xml\" reflects 120.0 % of the light on its front\n"), "{messages}");
}

/// The floats of a frozen octree turn a dome of 360 degrees into one of 360.00000005.
#[test]
fn a_dome_slightly_over_360_degrees_is_the_whole_sphere() {
    let scene = scene("void glow g 0 0 4 1 1 1 0 g source dome 0 0 4 0 0 1 360.0000000484288");
    let (_, dome) = scene.sources.iter().next().expect("a source");
    assert_eq!(dome.extent.full_angle, 2.0 * std::f64::consts::PI);
}
