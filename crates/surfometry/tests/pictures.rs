//! Pictures: what is drawn where, in which colour, and the same on any number of threads.
#![cfg(feature = "pictures")]

use std::f64::consts::{PI, TAU};

use surfometry::Choice;
use surfometry::integrals::{SmearedDelta, Smearing};
use surfometry::pictures::{
    Background, Camera, ColorScale, ColoredSurface, Figure, HistogramPicture, HistogramSeries, Palette,
    PictureError, PictureStyle, Quantity, Raster, ScaleKind, SceneSurface, Slice, SlicePicture,
    SurfacePicture, View, Viewpoint, VolumeRendering, render_surface,
};
use surfometry::surface::Mesh;
use surfometry::volume::Affine;

const H: Quantity = Quantity { name: "Mean curvature H", unit: "1/mm" };

/// A sphere of 120 x 60 quads, wound outward.
fn sphere(radius: f64, center: [f64; 3]) -> Mesh {
    let (across, down) = (120, 60);
    let mut mesh = Mesh::default();
    for j in 0..=down {
        for i in 0..across {
            let (theta, phi) = (PI * f64::from(j) / f64::from(down), TAU * f64::from(i) / f64::from(across));
            let direction = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), -theta.cos()];
            mesh.vertices.push(std::array::from_fn(|a| center[a] + radius * direction[a]));
        }
    }
    let id = |i: i32, j: i32| (j * across + i % across) as u32;
    for j in 0..down {
        for i in 0..across {
            mesh.triangles.push([id(i, j), id(i + 1, j), id(i + 1, j + 1)]);
            mesh.triangles.push([id(i, j), id(i + 1, j + 1), id(i, j + 1)]);
        }
    }
    assert!(mesh.volume() > 0.0);
    mesh
}

/// Two meshes as one, with one colour each.
fn joined(parts: [(Mesh, [u8; 3]); 2]) -> (Mesh, Vec<[u8; 3]>) {
    let (mut mesh, mut colors) = (Mesh::default(), Vec::new());
    for (part, color) in parts {
        let first = mesh.vertices.len() as u32;
        colors.extend(part.vertices.iter().map(|_| color));
        mesh.vertices.extend(part.vertices);
        mesh.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    (mesh, colors)
}

fn camera(view: View, mm_per_pixel: f64, size: [usize; 2]) -> Camera {
    Camera { basis: view.basis(), center: [0.0; 3], mm_per_pixel, size }
}

/// Mean place of the pixels that satisfy a condition, and their number.
fn centroid(raster: &Raster, mut is_meant: impl FnMut([u8; 4]) -> bool) -> ([f64; 2], usize) {
    let (mut sum, mut count) = ([0.0, 0.0], 0);
    for y in 0..raster.height {
        for x in 0..raster.width {
            if is_meant(raster.pixel([x, y])) {
                sum = [sum[0] + x as f64, sum[1] + y as f64];
                count += 1;
            }
        }
    }
    (sum.map(|s| s / f64::from(count.max(1))), count as usize)
}

fn decoded(file: &[u8]) -> Raster {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    let rgba = bytes.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]).collect();
    Raster { width: info.width as usize, height: info.height as usize, rgba }
}

fn on_threads<T: Send>(count: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap().install(run)
}

#[test]
fn a_sphere_is_a_disc_of_its_size_and_its_left_mirrors_its_right() {
    let mesh = sphere(10.0, [0.0; 3]);
    let colors = vec![[200, 120, 80]; mesh.vertices.len()];
    let surface = ColoredSurface { mesh: &mesh, colors: &colors, normals: &mesh.vertices, openness: &[] };
    for &view in View::ALL {
        let raster = render_surface(&surface, &camera(view, 0.1, [260, 240]), Background::Transparent);
        let cover: f64 = raster.rgba.chunks_exact(4).map(|p| f64::from(p[3]) / 255.0).sum();
        assert!((cover / (PI * 1e4) - 1.0).abs() < 3e-3, "{view} {cover}");
        let differing = (0..240).flat_map(|y| (0..130).map(move |x| [x, y])).filter(|[x, y]| {
            let (a, b) = (raster.pixel([*x, *y]), raster.pixel([259 - x, *y]));
            (0..4).any(|i| a[i].abs_diff(b[i]) > 6)
        });
        // The oblique view's mirror plane is none of the mesh's.
        assert!(view == View::Oblique || differing.count() < 40, "{view}");
        // Fully lit in the middle: the scale's own colour; nowhere brighter.
        let middle = raster.pixel([130, 118]);
        assert!((0..3).all(|i| middle[i].abs_diff([200, 120, 80][i]) <= 6), "{middle:?}");
        assert!(raster.rgba.chunks_exact(4).filter(|p| p[3] == 255).all(|p| p[0] <= 201));
    }
}

#[test]
fn every_view_has_the_landmarks_on_the_right_side() {
    let ball = |direction: [f64; 3]| {
        let bump = sphere(2.0, direction.map(|v| 9.5 * v));
        joined([(sphere(10.0, [0.0; 3]), [200; 3]), (bump, [0, 160, 0])])
    };
    // Way of the bump; then in each view: to the picture's right, up; 0 where it is in the middle.
    let (to_right, to_front, to_head) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let expected = [
        (View::Anterior, to_right, [-1, 0]),
        (View::Anterior, to_front, [0, 0]),
        (View::Anterior, to_head, [0, 1]),
        (View::Posterior, to_right, [1, 0]),
        (View::Left, to_front, [-1, 0]),
        (View::Left, to_head, [0, 1]),
        (View::Right, to_front, [1, 0]),
        (View::Superior, to_right, [1, 0]),
        (View::Superior, to_front, [0, 1]),
        (View::Inferior, to_right, [-1, 0]),
        (View::Inferior, to_front, [0, 1]),
        (View::Oblique, to_right.map(|v: f64| -v), [1, -1]),
        (View::Oblique, to_head, [0, 1]),
    ];
    for (view, way, [right, up]) in expected {
        let (mesh, colors) = ball(way);
        let surface = ColoredSurface { mesh: &mesh, colors: &colors, normals: &[], openness: &[] };
        let raster = render_surface(&surface, &camera(view, 0.25, [100, 100]), Background::White);
        let ([x, y], count) = centroid(&raster, |[r, g, _, _]| g > 40 && r < g / 2);
        assert!(count > 20, "{view} {way:?}");
        let side = |offset: f64| if offset.abs() < 3.0 { 0 } else { offset.signum() as i32 };
        assert_eq!((side(x - 49.5), side(49.5 - y)), (right, up), "{view} {way:?}");
    }
    // What is behind is hidden.
    let (mesh, colors) = ball(to_front);
    let surface = ColoredSurface { mesh: &mesh, colors: &colors, normals: &[], openness: &[] };
    let raster = render_surface(&surface, &camera(View::Posterior, 0.25, [100, 100]), Background::White);
    assert_eq!(centroid(&raster, |[r, g, _, _]| r < g / 2).1, 0);
}

fn surface_figure(mesh: &Mesh, title: &str, views: &[View]) -> Figure {
    let views: Vec<Viewpoint> = views.iter().copied().map(Viewpoint::from).collect();
    let values: Vec<f64> = mesh.vertices.iter().map(|v| 0.01 * v[2]).collect();
    let scale = ColorScale::robust(ScaleKind::Diverging, &values, &mesh.vertex_areas());
    let caption = "A sphere.";
    SurfacePicture {
        surfaces: &[SceneSurface { name: "", mesh, values: &values, normals: &mesh.vertices }],
        quantity: H,
        scale,
        views: &views,
        title,
        caption,
        width: None,
    }
    .figure()
    .unwrap()
}

#[test]
fn a_figure_holds_text_and_has_the_size_it_states() {
    let figure =
        surface_figure(&sphere(10.0, [0.0; 3]), "<script>alert(1)</script> & \"L4\"", &[View::Anterior]);
    let svg = figure.svg();
    assert!(
        !svg.contains("<script")
            && svg.contains("&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;L4&quot;")
    );
    assert!(
        svg.contains(">Mean curvature H (mm⁻¹)</text>")
            && svg.contains(">Anterior</text>")
            && svg.contains(" mm</text>")
    );
    assert!(!svg.contains(" id=") && !svg.contains("href=\"http"));
    let png = decoded(&figure.to_png(1.5).unwrap());
    let stated = [figure.width(), figure.height()].map(|v| (1.5 * v).round() as usize);
    assert_eq!([png.width, png.height], stated);
    // The title's line: dark letters on white, nothing else.
    let is_ink = |x: usize, y: usize| png.pixel([x, y])[..3].iter().all(|c| *c < 110);
    let ink = (24..54).flat_map(|y| (24..300).map(move |x| [x, y])).filter(|[x, y]| is_ink(*x, *y)).count();
    assert!((200..4000).contains(&ink), "{ink}");
    let (_, reddish) = centroid(&png, |[r, _, b, _]| r > b.saturating_add(40));
    let (_, bluish) = centroid(&png, |[r, _, b, _]| b > r.saturating_add(40));
    assert!(reddish > 10_000 && bluish > 10_000, "{reddish} {bluish}");
}

#[test]
fn the_upper_half_is_red_where_values_grow_upward() {
    let png = decoded(&surface_figure(&sphere(10.0, [0.0; 3]), "", &[View::Left]).to_png(1.0).unwrap());
    let ([_, red], _) = centroid(&png, |[r, _, b, _]| r > b.saturating_add(60));
    let ([_, blue], _) = centroid(&png, |[r, _, b, _]| b > r.saturating_add(60));
    assert!(red + 100.0 < blue, "{red} {blue}");
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let mesh = sphere(10.0, [3.0, 2.0, 1.0]);
    let draw = || surface_figure(&mesh, "Threads", View::ALL).to_png(0.7).unwrap();
    assert_eq!(on_threads(1, draw), on_threads(2, draw));
    let ball = Ball::new(8.0, [1.0, 1.0, 1.0], [26; 3]);
    let render =
        || ball.rendering().render(&camera(View::Oblique, 0.2, [120, 100]), Background::White).unwrap();
    assert_eq!(on_threads(1, render), on_threads(3, render));
}

#[test]
fn nothing_panics_on_what_has_no_picture() {
    let empty = Mesh::default();
    let figure = surface_figure(&empty, "", View::ALL);
    assert!(figure.svg().contains("no surface") && figure.to_png(1.0).is_ok());
    assert!(surface_figure(&empty, "", &[]).to_png(1.0).is_ok());
    let mut broken = sphere(5.0, [0.0; 3]);
    broken.vertices[70] = [f64::NAN; 3];
    broken.triangles.push([0, 1, 9_999_999]);
    let scale = ColorScale::robust(ScaleKind::Sequential, &[0.0; 9], &[]);
    let normals = [[0.0; 3]; 5];
    let picture = SurfacePicture {
        surfaces: &[SceneSurface { name: "", mesh: &broken, values: &[0.5, f64::NAN], normals: &normals }],
        quantity: H,
        scale,
        views: &[View::Oblique.into()],
        title: "",
        caption: "",
        width: None,
    };
    assert!(picture.figure().unwrap().to_png(1.0).is_ok());
    for scale in [0.0, -1.0, f64::NAN, 1e6] {
        assert!(matches!(figure.to_png(scale), Err(PictureError::Size { .. })), "{scale}");
    }
}

#[test]
fn histograms_show_shares_and_marks() {
    let edges = [0.0, 1.0, 2.0, 3.0, 4.0];
    let weights = [10.0, 30.0, 40.0, 20.0];
    let series = [
        HistogramSeries { name: "by area", weights: &weights, mean: Some(2.2), median: Some(2.25) },
        HistogramSeries {
            name: "by vertex",
            weights: &[1.0, 1.0, 1.0, 1.0],
            mean: Some(-70.0),
            median: None,
        },
    ];
    let scale = Some(ColorScale::new(ScaleKind::Sequential, 4.0));
    let picture = HistogramPicture {
        edges: &edges,
        series: &series,
        quantity: H,
        scale,
        title: "",
        caption: "",
        width: None,
    };
    let figure = picture.figure().unwrap();
    for text in
        ["by area", "by vertex", "mean 2.2 mm⁻¹", "median 2.25 mm⁻¹", "Share per bin (%)", ">40</text>"]
    {
        assert!(figure.svg().contains(text), "{text}");
    }
    // The filled area has the shares' shape: its right half holds (40 + 20) / 100.
    let png = decoded(&figure.to_png(1.0).unwrap());
    let plot = 74.0..594.0;
    let is_filling = |p: [u8; 4]| p[..3] == [0xcf, 0xe3, 0xf1];
    let columns = |from: f64, to: f64| {
        let pixels = (from as usize..to as usize).flat_map(|x| (60..png.height).map(move |y| [x, y]));
        pixels.filter(|at| is_filling(png.pixel(*at))).count() as f64
    };
    let right = columns(0.5 * (plot.start + plot.end), plot.end) / columns(plot.start, plot.end);
    assert!((right - 0.6).abs() < 0.02, "{right}");
    let nothing = HistogramPicture { edges: &[f64::NAN], series: &[], ..picture };
    assert!(nothing.figure().unwrap().svg().contains("no data"));
    let flat = HistogramPicture { edges: &[1.0, 1.0], ..picture };
    assert!(flat.figure().unwrap().to_png(1.0).is_ok());
}

#[test]
fn slices_have_u_to_the_right_and_v_upward() {
    let size = [8, 6];
    let corner = |i: usize| i % 8 < 2 && i / 8 < 2;
    let slice = Slice {
        name: "Axial, z = 0 mm".to_owned(),
        letters: ["L", "R", "P", "A"].map(String::from),
        size,
        spacing: [1.0, 2.0],
        mask: (0..48).map(corner).collect(),
        values: (0..48).map(|i| if corner(i) { -0.5 } else { 0.5 }).collect(),
        contour: vec![[[1.5, -0.5], [1.5, 1.5]], [[1.5, 1.5], [-0.5, 1.5]]],
    };
    let quantity = Quantity { name: "Embedding φ", unit: "" };
    let scale = ColorScale::new(ScaleKind::Diverging, 0.5);
    let slices = [slice];
    let picture = SlicePicture { slices: &slices, quantity, scale, title: "", caption: "", width: None };
    let png = decoded(&picture.figure().unwrap().to_png(1.0).unwrap());
    let (outside, n_outside) = centroid(&png, |p| p[..3] == [246; 3]);
    let (inside, n_inside) = centroid(&png, |p| p[..3] == [176; 3]);
    assert!(inside[0] < outside[0] && inside[1] > outside[1]);
    let share = n_inside as f64 / (n_inside + n_outside) as f64;
    assert!((share - 4.0 / 48.0).abs() < 0.01, "{share}");
    // The contour runs along the corner's upper and right edge.
    let (contour, n) = centroid(&png, |[r, g, b, _]| r > 150 && g < 120 && g.abs_diff(b) < 20 && r > g + 50);
    assert!(n > 50 && contour[0] > inside[0] && contour[1] < inside[1], "{n} {contour:?} {inside:?}");
    let nothing = SlicePicture { slices: &[], ..picture };
    assert!(nothing.figure().unwrap().to_png(1.0).is_ok());
}

/// Signed distance to a sphere in the middle of a block, and 1 / distance to that middle.
struct Ball {
    dimensions: [usize; 3],
    affine: Affine,
    phi: Vec<f32>,
    curvature: Vec<f32>,
}

impl Ball {
    fn new(radius: f64, spacing: [f64; 3], dimensions: [usize; 3]) -> Self {
        let origin: [f64; 3] = std::array::from_fn(|a| -0.5 * spacing[a] * (dimensions[a] - 1) as f64);
        // The first axis grows to the left: an affine that mirrors.
        let mut affine = Affine { origin, ..Affine::diagonal(spacing) };
        affine.linear[0][0] *= -1.0;
        affine.origin[0] *= -1.0;
        let distances = (0..dimensions.iter().product()).map(|i: usize| {
            let [nx, ny, _] = dimensions;
            let world = affine.apply([i % nx, i / nx % ny, i / (nx * ny)].map(|v| v as f64));
            world.iter().map(|v| v * v).sum::<f64>().sqrt()
        });
        let (phi, curvature) = distances.map(|d| ((d - radius) as f32, (1.0 / d.max(1e-3)) as f32)).unzip();
        Self { dimensions, affine, phi, curvature }
    }

    fn rendering(&self) -> VolumeRendering<'_> {
        VolumeRendering {
            dimensions: self.dimensions,
            affine: self.affine,
            phi: &self.phi,
            values: &self.curvature,
            delta: SmearedDelta::new(Smearing::Sine, 1.0, f64::INFINITY),
            quantity: H,
            scale: ColorScale::new(ScaleKind::Diverging, 0.2),
            views: &[Viewpoint::Named(View::Anterior), Viewpoint::Named(View::Oblique)],
            title: "Ball",
            caption: "",
            width: None,
        }
    }
}

#[test]
fn a_rendered_ball_is_a_disc_of_its_diameter_and_curvature() {
    let ball = Ball::new(10.0, [0.5, 1.0, 0.75], [60, 30, 40]);
    for view in [View::Anterior, View::Left, View::Inferior, View::Oblique] {
        let raster =
            ball.rendering().render(&camera(view, 0.2, [130, 130]), Background::Transparent).unwrap();
        let opaque = |at: [usize; 2]| raster.pixel(at)[3] > 127;
        let across = (0..130).filter(|x| opaque([*x, 65])).count();
        let down = (0..130).filter(|y| opaque([65, *y])).count();
        // Rays that graze the smeared layer gather opacity over some way: the disc is larger by a part of
        // eps.
        assert!((100..=108).contains(&across) && (100..=108).contains(&down), "{view} {across} {down}");
        let [r, g, b, _] = raster.pixel([65, 63]);
        let expected = ColorScale::new(ScaleKind::Diverging, 0.2).rgb(0.1);
        assert!([r, g, b].iter().zip(expected).all(|(c, e)| c.abs_diff(e) < 16), "{r} {g} {b} {expected:?}");
    }
}

#[test]
fn volume_renderings_are_framed_and_refuse_what_does_not_fit() {
    let ball = Ball::new(4.0, [1.0; 3], [12; 3]);
    let figure = ball.rendering().figure().unwrap();
    assert!(figure.svg().contains(">Oblique</text>") && figure.svg().contains("mm⁻¹"));
    let short = VolumeRendering { phi: &ball.phi[1..], ..ball.rendering() };
    assert!(matches!(short.figure(), Err(PictureError::Values { expected: 1728, found: 1727 })));
    let flat = VolumeRendering { affine: Affine::diagonal([1.0, 0.0, 1.0]), ..ball.rendering() };
    assert!(matches!(flat.figure(), Err(PictureError::SingularAffine)));
    let nothing = VolumeRendering { dimensions: [0; 3], phi: &[], values: &[], ..ball.rendering() };
    assert!(nothing.figure().unwrap().svg().contains("no surface"));
    let thin = VolumeRendering { dimensions: [1, 1, 1728], ..ball.rendering() };
    assert!(thin.figure().unwrap().to_png(1.0).is_ok());
}

/// A picture of a width of its own: exactly that wide, its text as large as ever, the object filling what is left.
#[test]
fn a_figure_may_be_as_wide_as_a_column() {
    let mesh = sphere(10.0, [0.0; 3]);
    let values: Vec<f64> = mesh.vertices.iter().map(|v| 0.01 * v[2]).collect();
    let surfaces = [SceneSurface { name: "", mesh: &mesh, values: &values, normals: &mesh.vertices }];
    let drawn = |width: Option<f64>| {
        SurfacePicture {
            surfaces: &surfaces,
            quantity: H,
            scale: ColorScale::new(ScaleKind::Diverging, 0.1),
            views: &[View::Anterior.into()],
            title: "",
            caption: "",
            width,
        }
        .figure()
        .unwrap()
    };
    let ball = |figure: &Figure| {
        let png = decoded(&figure.to_png(1.0).unwrap());
        let colored = |[r, _, b, _]: [u8; 4]| r.abs_diff(b) > 40;
        // Left of the colour bar.
        (0..png.width - 80).filter(|x| (0..png.height).any(|y| colored(png.pixel([*x, y])))).count()
    };
    let mut last = 0;
    for mm in [60.0, 85.0, 180.0] {
        let width = mm / 25.4 * 96.0;
        let figure = drawn(Some(width));
        assert!((figure.width() - width).abs() < 1e-9 && figure.svg().contains("font-size=\"13\""));
        let png = decoded(&figure.to_png(300.0 / 96.0).unwrap());
        assert_eq!(png.width, (mm / 25.4 * 300.0f64).round() as usize);
        let across = ball(&figure);
        assert!(across > last + 60, "{mm} {across} {last}");
        last = across;
    }
}

/// Surfaces of several inputs stand beside each other, at one scale of lengths, each under its name.
#[test]
fn surfaces_beside_each_other_share_their_scales() {
    let (small, large) = (sphere(5.0, [40.0, 0.0, 0.0]), sphere(10.0, [0.0; 3]));
    let values: Vec<f64> = vec![0.2; small.vertices.len()];
    let of = |name, mesh: &'static Mesh| SceneSurface { name, mesh, values: &[], normals: &[] };
    let [small, large]: [&'static Mesh; 2] = [small, large].map(|mesh| &*Box::leak(Box::new(mesh)));
    let surfaces = [
        SceneSurface { values: &values, ..of("small <b>", small) },
        SceneSurface { values: &values, ..of("large", large) },
    ];
    let figure = SurfacePicture {
        surfaces: &surfaces,
        quantity: H,
        scale: ColorScale::new(ScaleKind::Diverging, 0.2),
        views: &[View::Anterior.into()],
        title: "",
        caption: "",
        width: None,
    }
    .figure()
    .unwrap();
    assert!(figure.svg().contains(">small &lt;b&gt;</text>") && figure.svg().contains(">large</text>"));
    let png = decoded(&figure.to_png(1.0).unwrap());
    let is_red = |[r, _, b, _]: [u8; 4]| r > b.saturating_add(60);
    // The colour bar is at the right.
    let columns: Vec<usize> = (0..png.width - 100)
        .map(|x| (0..png.height).filter(|y| is_red(png.pixel([x, *y]))).count())
        .collect();
    let widths: Vec<usize> =
        columns.split(|n| *n == 0).map(<[usize]>::len).filter(|length| *length > 20).collect();
    let [small, large] = widths[..] else { panic!("{widths:?}") };
    assert!((large as f64 / small as f64 - 2.0).abs() < 0.05, "{widths:?}");
}

/// PDF is read by other programs in tests/oracles; here its page, its font, and that nothing else is in it.
#[test]
fn a_pdf_has_the_figures_page_and_its_font() {
    let title = "<script>alert(1)</script>) /JS (app.alert(1)) \u{3b1}";
    let figure = surface_figure(&sphere(10.0, [0.0; 3]), title, &[View::Anterior]);
    let pdf = figure.to_pdf().unwrap();
    assert!(pdf.starts_with(b"%PDF-") && pdf.ends_with(b"%%EOF"));
    let text = String::from_utf8_lossy(&pdf);
    let page = format!("/MediaBox [0 0 {} {}]", 0.75 * figure.width(), 0.75 * figure.height());
    assert!(text.contains(&page), "{page}");
    assert!(text.contains("/FontFile2") && text.contains("+DejaVuSans") && text.contains("/ToUnicode"));
    assert_eq!(text.matches("/Subtype /Image").count(), 2);
    for word in ["/JavaScript", "/OpenAction", "/Launch"] {
        assert!(!text.contains(word), "{word}");
    }
    assert_eq!(pdf, on_threads(3, || figure.to_pdf().unwrap()));
}

#[test]
fn limits_of_one_sign_do_not_diverge() {
    let surface = surfometry::surface::Surface::default();
    let of = |range| PictureStyle { range: Some(range), ..PictureStyle::default() }.color_scale(&surface);
    assert_eq!(of([-0.1, 0.4]).kind(), ScaleKind::Diverging);
    assert_eq!((of([0.1, 0.4]).kind(), of([0.1, 0.4]).limits()), (ScaleKind::Sequential, [0.1, 0.4]));
    let chosen =
        PictureStyle { palette: Some(Palette::Cividis), limit: Some(0.3), ..PictureStyle::default() };
    assert_eq!(chosen.color_scale(&surface).limits(), [-0.3, 0.3]);
}
