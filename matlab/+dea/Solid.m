classdef Solid < dea.Object
  % The 3D engine with a mesh of one's own, or a box: elements, materials, supports, loads.
  %
  %   rubber = dea.Part('neo-hookean', 0.4e6);
  %   s = dea.Solid(rubber, 'box_m', [0.01 0.01 0.04], 'elements', [1 1 2]);
  %   s.hold('xyz', [0 0 0], 'high_m', [1 1 0]);
  %   s.hold('z', [0 0 0.04], 'low_m', [0 0 0.04]);
  %   s.solve();
  %   s.get('reaction_N')
  %
  % s.get(NAME) is an array, one row a point, or a number; [values, unit] = s.get(NAME):
  %   points_m, displacement_m, reaction_N, force_N     of points
  %   mode_Hz (negative: unstable), mode_shape          after modes
  %   body_shift_m, body_turn_rad                       of bodies, and what holds them:
  %   body_force_N, body_moment_N_m
  %   spring_force_N, spring_moment_N_m                 what springs pull back by
  %   channel_V, charge_C, capacitance_held_F, capacitance_F   after find_charges, ground first
  %   voltage_V, energy_J, unstable_modes, iterations, load, arc
  %
  % Parts, plies, nodes, bodies and springs count from 1. Supports, loads and voltages are goals of
  % the next solve. A solve that fails, and one that Ctrl-C ends, leave the solid at its last
  % equilibrium.

  properties (SetAccess = protected, Hidden)
    springs = 0;
  end

  methods
    function self = Solid(parts, varargin)
      % dea.Solid(PARTS, OPTION, VALUE, ...). The mesh is one of three:
      %   'box_m', 'elements'  a box from the origin, of part 1, with so many elements along x, y, z
      %   'points_m', 'cells', 'part_of'  points, one row each; hexahedra, one row each of
      %       (order + 1)^2 (order_z + 1) nodes, first local axis fastest, at Gauss-Lobatto points;
      %       part of each ([]: 1)
      %   'msh_file', 'msh_unit_m', 'ply_thickness_m', 'ply_elements', 'fills'  a plane mesh of
      %       quadrilaterals from a file of Gmsh (lengths in units of 1e-3 m, or as given), extruded
      %       through plies from z = 0 up, with so many elements through each ([]: 1), and the parts
      %       that plies have where (dea.Fill), later ones over earlier ones
      % 'order', 'order_z': of the elements in the plane and through the thickness, 1 to 3 (2).
      % 'bodies': dea.Body, at first free; they bring two points each, behind those of the mesh.
      o = dea.options(struct('box_m', [], 'elements', [1 1 1], 'points_m', [], 'cells', [], ...
                             'part_of', [], 'msh_file', '', 'msh_unit_m', 1e-3, ...
                             'ply_thickness_m', [], 'ply_elements', [], 'fills', [], ...
                             'bodies', [], 'order', 2, 'order_z', 2), varargin);
      o.points_m = double(o.points_m)';
      o.cells = double(o.cells)';
      o.part_of = double(o.part_of);
      o.msh_file = char(o.msh_file);
      self.id = dea_mex('solid_new', parts, o.bodies, o);
    end

    function hold(self, components, displacement_m, varargin)
      % hold('xz', [0 0 1e-3], 'low_m', LOW, 'high_m', HIGH): components of the nodes in that box,
      % at a displacement that the next solve goes to ([]: 0). 'curve': of these only nodes on,
      % above and below a physical curve of the .msh file. 'nodes': those instead, rows of points_m,
      % or true for each.
      if isempty(displacement_m)
        displacement_m = [0 0 0];
      end
      hold_there(self.id, components, displacement_m, varargin);
    end

    function release(self, components, varargin)
      % Frees what hold holds; 'low_m', 'high_m', 'curve', 'nodes' as there.
      hold_there(self.id, components, [], varargin);
    end

    function hold_body(self, body, components, shift_m, turn_rad)
      % Components of a body ('z', or a cell array of 'x', 'y', 'z' of its shift and 'rx', 'ry',
      % 'rz' of its rotation vector; {}: all) at values that the next solve goes to, 0 if not given.
      if nargin < 4 || isempty(shift_m)
        shift_m = [0 0 0];
      end
      if nargin < 5
        turn_rad = [0 0 0];
      end
      dea_mex('solid_hold_body', self.id, body, bits(components), shift_m, turn_rad);
    end

    function release_body(self, body, components)
      % Frees what hold_body holds.
      dea_mex('solid_hold_body', self.id, body, bits(components), [], []);
    end

    function push_body(self, body, force_N, moment_N_m)
      % A dead force at the centre of a body, and a moment (while turns are small), in place of what
      % was there.
      if nargin < 4
        moment_N_m = [0 0 0];
      end
      dea_mex('solid_push_body', self.id, body, force_N, moment_N_m);
    end

    function number = add_spring(self, body, component, varargin)
      % add_spring(1, 'z', 'place', 1e-3, 'stiffness', 50): between a component of a body and the
      % outside; it pulls back by F(y), y: how far the component is beyond the place (m, or rad; 0).
      % F = stiffness y (N/m, or N m/rad), or 'table', {Y, F} with rising Y: a monotone cubic,
      % straight on beyond its ends. The next solve brings its outer end from where the body is to
      % its place.
      o = dea.options(struct('place', 0, 'stiffness', 0, 'table', {{[], []}}), varargin);
      dea_mex('solid_add_spring', self.id, body, bits(component), o.place, o.stiffness, ...
              double(o.table{1}), double(o.table{2}));
      self.springs = self.springs + 1;
      number = self.springs;
    end

    function move_spring(self, spring, place)
      % Another place of a spring's outer end, that the next solve goes to.
      dea_mex('solid_move_spring', self.id, spring, place);
    end

    function pull(self, traction_Pa, varargin)
      % pull(TRACTION, 'low_m', LOW, 'high_m', HIGH) adds a force per reference area on the faces of
      % elements whose middles are there; an outer face of the solid is a box without thickness.
      o = dea.options(struct('low_m', [], 'high_m', []), varargin);
      [low_m, high_m] = dea.corners(o.low_m, o.high_m);
      dea_mex('solid_pull', self.id, traction_Pa, low_m, high_m);
    end

    function set_channel(self, channel, voltage_V)
      % Voltage of a channel beside that of solve, which all channels have.
      dea_mex('solid_set_channel', self.id, channel, voltage_V);
    end

    function solve(self, voltage_V)
      % Stable equilibrium with these supports, loads and voltage (0 V), in steps where they are
      % needed. Error dea:no_equilibrium or dea:not_converged when there is none.
      if nargin < 2
        voltage_V = 0;
      end
      dea_mex('solid_solve', self.id, voltage_V);
    end

    function find_charges(self)
      % Charges and capacitances at the last equilibrium, with the film held and moving.
      dea_mex('solid_find_charges', self.id);
    end

    function modes(self, count)
      % The lowest natural modes at the last equilibrium, 1 to 200.
      dea_mex('solid_modes', self.id, count);
    end

    function path_begin(self, voltage_V, step, unit_m)
      % Begins a path by arc-length, through unstable equilibria too, from the last equilibrium
      % (load 0) to what is now asked for (load 1), and beyond. STEP: length of the first step
      % (below 0: the other way); UNIT_M: a displacement that counts as much as the whole load.
      dea_mex('solid_path_begin', self.id, voltage_V, step, unit_m);
    end

    function path_step(self)
      % The next point of the path: load, arc, voltage_V, unstable_modes.
      dea_mex('solid_path_step', self.id);
    end

    function found = mesh(self)
      % Stretches, stresses, tension, field, energy and error of volume at the last equilibrium, as
      % dea.Result.mesh has them. A point is one node in one ply and part; region is a cell's part
      % less 1.
      found = dea_mex('solid_mesh', self.id);
    end

    function all = settings(self)
      % Tolerances and limits of the solvers: array of structs with name, unit, meaning, value.
      all = dea_mex('solid_settings', self.id);
    end

    function set(self, name, value)
      % Changes a setting for the solves to come.
      dea_mex('solid_set', self.id, char(name), value);
    end

    function [values, unit] = get(self, name)
      [values, unit] = dea_mex('solid_get', self.id, char(name));
    end
  end
end

function mask = bits(components)
  known = {'x', 'y', 'z', 'rx', 'ry', 'rz'};
  if ischar(components) && ~any(strcmp(components, known))
    components = num2cell(components);
  elseif isempty(components)
    components = known;
  end
  [found, at] = ismember(components, known);
  if ~all(found)
    error('dea:argument', 'components are: %s', strjoin(known, ', '));
  end
  mask = sum(2.^(unique(at) - 1));
end

function hold_there(id, components, displacement_m, options)
  o = dea.options(struct('low_m', [], 'high_m', [], 'curve', '', 'nodes', []), options);
  nodes = o.nodes;
  if islogical(nodes)
    nodes = find(nodes);
  end
  place = [numel(o.low_m), numel(o.high_m), numel(o.curve)];
  if any(place) && ~isempty(o.nodes)
    error('dea:argument', 'nodes by their numbers, or by a place');
  end
  [low_m, high_m] = dea.corners(o.low_m, o.high_m);
  dea_mex('solid_hold', id, bits(components), displacement_m, low_m, high_m, char(o.curve), ...
          double(nodes(:)));
end
