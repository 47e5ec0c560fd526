% What the package dea promises, against the command's results.h5 in by_command and against itself.
% Run by test_octave_tutorial.sh, which sets source_folder.

function expect_error(identifier, part, f)
  try
    f();
  catch e
    assert(e.identifier, identifier);
    assert(~isempty(strfind(e.message, part)), e.message);
    return;
  end
  error('no error %s', identifier);
end

assert(~isempty(regexp(dea.version(), '^\d+\.\d+\.\d+$')));
models = dea.models();
of_3d = models(strcmp({models.name}, '3d'));
assert(of_3d.available && any(strcmp(of_3d.abilities, 'indent')));
assert(all(ismember({'time', 'indent'}, of_3d.layout_abilities)));
assert(~any(strcmp(models(strcmp({models.name}, 'lumped')).abilities, 'indent')));
studies = dea.studies();
assert(any(strcmp({studies.name}, 'sweep')));

% designs: values, units, places
file = fullfile(source_folder, 'examples', 'frdea-4.yaml');
d = dea.Design(file);
t = d.get('film.thickness');
assert({t.text, t.unit, t.origin}, {'100 um', 'm', 'given'});
assert(t.si, 100e-6, -1e-15);
lines = strsplit(fileread(file), "\n", "CollapseDelimiters", false);
assert(lines{t.line}(t.column:t.column + 5), '100 um');
e = d.copy();
same = d;
d.set('film.thickness', '80 um', 'fibres.count', 6, 'compute.models', {'lumped'});
assert(same.get('film.thickness').text, '80 um');
assert(d.get('film.thickness').origin, 'set');
assert(e.get('film.thickness').text, '100 um');
assert(d.get('fibres.count').si, 6);
assert(dea.Design.parse(d.yaml()).get('film.thickness').si, 80e-6, -1e-15);
expect_error('dea:design', 'did you mean', @() d.set('film.thicknes', '80 um'));
expect_error('dea:design', 'has no unit', @() d.set('film.thickness', 80));
assert(d.get('film.thickness').text, '80 um');
expect_error('dea:design', 'it:2:19: error: thickness', ...
             @() dea.Design.parse(sprintf('dea: 1\nfilm: {thickness: 3 kV}\n'), 'it'));
found = dea.findings();
found = found(~cellfun(@isempty, strfind({found.text}, '3 kV')));
assert({found.severity, found.file, found.line, found.column}, {'error', 'it', 2, 19});
expect_error('dea:io', 'nowhere.yaml', @() dea.Design('nowhere.yaml'));
expect_error('dea:argument', 'no.such', @() d.get('no.such'));
expect_error('dea:argument', 'no such option', @() dea.run(d, 'colour', 'red'));
assert(any(strfind(d.svg(), '<svg')));

% results: the same numbers as the command's
e.set('compute.voltage', '{from: 0 kV, to: 4 kV, step: 0.5 kV}');
r = dea.run(e, 'models', 'lumped', 'progress', false);
p = r.table('lumped/sweep');
assert(any(strcmp(r.curves(), 'lumped/path')));
x = load('by_command/results.h5').curves.lumped;
keys = setdiff(fieldnames(x.sweep), 'events');
assert(sort(fieldnames(p)), sort(keys));
for i = 1:numel(keys)
  assert(p.(keys{i}), double(x.sweep.(keys{i})(:)));
end
[z, unit, meaning] = r.array('lumped/path/centre_z_m');
assert(z, x.path.centre_z_m(:));
assert(unit, 'm');
assert(any(strfind(meaning, 'centre')));
old = dea.Result('by_command');
assert(old.table('lumped/path'), r.table('lumped/path'));
assert(r.text('lumped/sweep/status'), 'DEA_OK');
assert(r.design().get('compute.voltage.to').si, 4000);
expect_error('dea:argument', 'nothing', @() r.array('nothing'));
expect_error('dea:argument', 'nothing', @() r.table('nothing'));
r.save('saved.h5');
r.write('written', 'figures', false);
expect_error('dea:io', 'written', @() r.write('written', 'figures', false));
saved = dea.Result('saved.h5');
written = dea.Result('written');
assert(saved.table('lumped/sweep'), p);
assert(written.table('lumped/sweep'), p);
assert(~isempty(strfind(r.figure('stretch'), '<svg')));
a = dea.Actuator(e, 'lumped');
a.solve(2000);
assert(a.get('electrode_stretch'), p.electrode_stretch(p.voltage_V == 2000), 1e-9);
expect_error('dea:unsupported', 'indent', @() a.indent(1e-4, 1e-3));
expect_error('dea:argument', 'cube', @() a.indent(1e-4, 1e-3, 'cube'));

% meshes: a plane film of that area, nodes counted from 1; fields of points and of cells
e.set('compute.solid.film', 'membrane', 'compute.voltage', ...
      '{from: 0 kV, to: 1 kV, step: 1 kV}');
r = dea.run(e, 'models', '3d', 'studies', 'sweep', 'progress', false);
assert(r.meshes(), {'3d/surface/0000', '3d/surface/0001'});
part = r.mesh('3d/surface/0001', false);
whole = r.mesh('3d/surface/0001');
assert(whole.voltage_V, 1000);
assert(size(whole.points, 1), 2 * part.fold * size(part.points, 1));
area = 0;
f = dea.faces(whole);
for i = 1:2 % two triangles
  corners = f(:, [1, i + 1, i + 2]);
  X = whole.points(:, 1)(corners);
  Y = whole.points(:, 2)(corners);
  area = area + sum(abs((X(:, 2) - X(:, 1)) .* (Y(:, 3) - Y(:, 1)) ...
                        - (X(:, 3) - X(:, 1)) .* (Y(:, 2) - Y(:, 1)))) / 2;
end
assert(area, pi * 15e-3^2, -0.01); % a polygon in the circle
assert(max(f(:)), size(whole.points, 1));
assert(min(f(:)), 1);
u = whole.fields.displacement_m;
assert(size(u), size(whole.points));
[~, centre] = min(sum(whole.points.^2, 2));
assert(u(centre, 3), r.table('3d/sweep').centre_z_m(2), 1e-12);
cells = sum(cellfun(@rows, {whole.cells.nodes}));
about = struct2cell(whole.about);
of_cells = cellfun(@(one) one.of_cells, about);
assert(any(of_cells));
values = struct2cell(whole.fields);
assert(all(cellfun(@rows, values(of_cells)) == cells));

% solids: a bar that is pulled (mu (l - 1/l^2)), by a box and by points and cells
mu = 0.4e6;
rubber = dea.Part('neo-hookean', mu, 'density_kg_per_m3', 1000);
bar = dea.Solid(rubber, 'box_m', [0.01 0.01 0.04], 'elements', [1 1 2]);
X = bar.get('points_m');
[~, order] = sortrows(round(1e6 * X), [3 2 1]);
cells = [order(1:27)'; order(19:45)'];
soft = dea.Part('', [], 'young_modulus_Pa', 1e3);
other = dea.Solid([soft, rubber], 'points_m', X, 'cells', cells, 'part_of', [2 2]);
assert(other.get('points_m'), X);
for s = {bar, other}
  one = s{1};
  one.hold('x', [], 'high_m', [0 1 1]);
  one.hold({'y'}, [], 'high_m', [1 0 1]);
  one.hold('z', [], 'nodes', X(:, 3) == 0);
  one.pull([0 0 mu * (1.5 - 1.5^-2)], 'low_m', [0 0 0.04]);
  one.solve();
  [u, unit] = one.get('displacement_m');
  assert(u(X(:, 3) > 0.0399, 3), 0.02 * ones(9, 1), -1e-6);
  assert(unit, 'm');
end
assert(bar.get('energy_J'), other.get('energy_J'), -1e-9);
m = other.mesh();
assert(m.fields.principal_stress_Pa(:, 1), mu * (2.25 - 1 / 1.5) * ones(size(X, 1), 1), -1e-5);
assert(m.fields.region, [1; 1]);
bar.pull([0 0 -mu * (1.5 - 1.5^-2)], 'low_m', [0 0 0.04]);
bar.solve();
bar.modes(1);
assert(bar.get('mode_Hz'), sqrt(3 * mu / 1000) / 0.16, -0.03); % slender, one end held
assert(size(bar.get('mode_shape')), [1, size(X)]);
expect_error('dea:argument', 'displacement_m', @() bar.get('displacement'));
expect_error('dea:argument', 'components are', @() bar.hold('w', []));
expect_error('dea:argument', 'no node 45', @() bar.hold('x', [], 'nodes', 46));
expect_error('dea:argument', 'neo-hookean', ...
             @() dea.Solid(dea.Part('neo-hooke', 1e5), 'box_m', [1 1 1]));
bar.set('newton_max_iterations', 1);
found = bar.settings();
assert(found(strcmp({found.name}, 'newton_max_iterations')).value, 1);
bar.pull([0 0 mu], 'low_m', [0 0 0.04]);
expect_error('dea:not_converged', 'after 1 iterations', @() bar.solve());
laws = dea.laws();
assert(any(strcmp({laws.name}, 'yeoh')));

% a rigid end on a spring, linear and by a table: where it pulls as the bar does
held = dea.Solid(rubber, 'box_m', [0.01 0.01 0.04], 'elements', [1 1 2], ...
                 'bodies', dea.Body('low_m', [0 0 0.04]));
held.hold('xyz', [], 'high_m', [1 1 0]);
held.hold_body(1, {}, [0 0 4e-3]);
held.solve();
F = held.get('body_force_N')(3);
assert(F > 3 * mu * 1e-4 * 0.09);
held.release_body(1, 'z');
assert(held.add_spring(1, 'z', 'place', 4e-3 + F / 500, 'stiffness', 500), 1);
held.solve();
assert(held.get('body_shift_m'), [0 0 4e-3], 1e-9);
assert(held.get('spring_force_N'), -F, -1e-6);
held.move_spring(1, 0);
held.add_spring(1, 'z', 'table', {[0 4e-3 8e-3], [-5, -F - 500 * 4e-3, 0]});
held.solve();
assert(held.get('body_shift_m'), [0 0 4e-3], 1e-9);
held.push_body(1, [0 0 1]);
held.solve();
assert(held.get('body_shift_m')(3) > 4.1e-3);

% channels: a plate capacitor; a plane mesh of Gmsh; the peak of a path
plates = dea.Solid(dea.Part('neo-hookean', 1e5, 'permittivity', 3, 'electrode_gap_m', 5e-5), ...
                   'box_m', [1e-3 1e-3 5e-5]);
plates.hold('xyz', []);
plates.set_channel(1, 500);
plates.solve(1000);
plates.find_charges();
C = 3 * 8.8541878128e-12 * 1e-6 / 5e-5;
assert(plates.get('charge_C'), [-1500; 1500] * C, -1e-9);
assert(plates.get('capacitance_F'), [C, -C; -C, C], -1e-9);
msh = fullfile(source_folder, 'tests', 'fuzz', 'seeds', 'msh', 'two-squares-41.msh');
plies = dea.Solid(rubber, 'msh_file', msh, 'ply_thickness_m', [1e-4 2e-4], ...
                  'ply_elements', [2 1], 'fills', [dea.Fill(1, '', 1), dea.Fill(2, 'film', 1), ...
                                                   dea.Fill(2, 'electrode', 1)]);
assert(size(plies.get('points_m')), [15 * 7, 3]);
plies.hold('x', [], 'curve', 'left');
expect_error('dea:argument', 'right', @() plies.hold('x', [], 'curve', 'right'));
film = dea.Solid(dea.Part('neo-hookean', mu, 'permittivity', 3, 'electrode_gap_m', 1e-4), ...
                 'box_m', [1e-3 1e-3 1e-4]);
film.hold('x', [], 'high_m', [0 1 1]);
film.hold('y', [], 'high_m', [1 0 1]);
film.hold('z', [], 'high_m', [1 1 0]);
film.solve();
peak = 1e-4 * sqrt(mu / (3 * 8.8541878128e-12) * (4^(-1 / 3) - 4^(-4 / 3))); % l^6 = 4
film.path_begin(2 * peak, 0.05, 1e-3);
volts = 0;
while numel(volts) < 200 && volts(end) == max(volts)
  film.path_step();
  volts(end + 1) = film.get('voltage_V');
end
assert(max(volts), peak, -5e-3);

% what was freed, and numbers that are none
id = a.id;
clear a;
expect_error('dea:argument', 'no longer', @() dea_mex('actuator_get', id, 'centre_z_m'));
expect_error('dea:argument', 'no longer', @() dea_mex('design_yaml', r.id));
expect_error('dea:argument', 'solid is no longer', @() dea_mex('solid_modes', r.id, 1));
expect_error('dea:argument', 'arguments', @() dea_mex('design_yaml'));
